//! The place in the network of the applications of a run: of one of them at most.

use system_model::network::NetworkSpecification;
use system_profile::{LoadOptions, Severity, load_application};

use super::applications::Sources;
use super::{ClockArgument, Failed, exit_code};

/// The number of the application that is in a network, and what it says of that. Several robots in
/// one container of simulated time need no network. The files have been read before, so they have no
/// mistakes.
pub(super) fn of(
    sources: &Sources<'_>,
    clock: ClockArgument,
) -> Result<Option<(usize, NetworkSpecification)>, Failed> {
    let options = LoadOptions {
        search_paths: sources.search_path.to_vec(),
        dangling: Severity::Error,
    };
    let files = sources.applications.iter().enumerate();
    let networks =
        files.filter_map(|(index, file)| Some((index, load_application(file, &options).network?)));
    choose(networks.collect(), clock).map_err(|text| Failed {
        code: exit_code::PROFILE,
        text,
    })
}

/// The network that is entered, or why none can be.
fn choose(
    mut networks: Vec<(usize, NetworkSpecification)>,
    clock: ClockArgument,
) -> Result<Option<(usize, NetworkSpecification)>, String> {
    let has_links =
        |it: &NetworkSpecification| !it.offers.is_empty() || !it.remote_inputs.is_empty();
    match (networks.len(), clock) {
        (0, _) => Ok(None),
        (1, ClockArgument::Real) => Ok(networks.pop()),
        (1, ClockArgument::Simulated) => Err(
            "other robots do not wait for simulated time\n  help: run with --clock real, run all robots \
             in this container, or leave <network> out of the application"
                .to_owned(),
        ),
        (_, ClockArgument::Real) => Err(
            "two applications of this run have a <network>\n  help: a robot is in the network once: \
             leave it in one of them, or run each in a container of its own"
                .to_owned(),
        ),
        (_, ClockArgument::Simulated) => match networks.iter().find(|(_, it)| has_links(it)) {
            None => Ok(None),
            Some((_, linked)) => Err(format!(
                "robot '{}' offers or takes data over the network, which is not entered in simulated \
                 time\n  help: run each robot with --clock real in a container of its own, or leave \
                 <offer> and <remote_connection> to a task",
                linked.robot
            )),
        },
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// What the shipped applications of two robots say of the network.
    fn robots(names: &[&str]) -> Vec<(usize, NetworkSpecification)> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../profiles/applications");
        let network = |name: &&str| {
            let file = folder.join(format!("visual_servoing_{name}.xml"));
            let outcome = load_application(&file, &LoadOptions::default());
            outcome.network.expect("a robot among robots")
        };
        names.iter().map(network).enumerate().collect()
    }

    #[test]
    fn one_robot_enters_in_real_time_and_several_are_simulated_without() {
        use ClockArgument::{Real, Simulated};
        let one = || robots(&["r1"]);
        let two = || robots(&["r1", "r2"]);
        assert_eq!(choose(Vec::new(), Simulated), Ok(None));
        assert_eq!(choose(one(), Real), Ok(one().pop()));
        assert!(choose(one(), Simulated).is_err());
        assert!(choose(two(), Real).is_err());
        assert_eq!(choose(two(), Simulated), Ok(None));
        let linked = choose(robots(&["r1", "offered_r2"]), Simulated);
        assert!(linked.unwrap_err().contains("'R2'"));
    }
}
