//! The place in the network of the applications of a run: of one of them at most.

use system_model::network::NetworkSpecification;
use system_profile::{LoadOptions, Severity, load_application};

use super::applications::Sources;
use super::{ClockArgument, Failed, exit_code};

/// The number of the application that is in a network, and what it says of that. The files have been
/// read before, so they have no mistakes.
pub(super) fn of(
    sources: &Sources<'_>,
    clock: ClockArgument,
) -> Result<Option<(usize, NetworkSpecification)>, Failed> {
    let options = LoadOptions {
        search_paths: sources.search_path.to_vec(),
        dangling: Severity::Error,
    };
    let files = sources.applications.iter().enumerate();
    let mut networks =
        files.filter_map(|(index, file)| Some((index, load_application(file, &options).network?)));
    let found = networks.next();
    let refuse = |text: &str| {
        Err(Failed {
            code: exit_code::PROFILE,
            text: text.to_owned(),
        })
    };
    if networks.next().is_some() {
        return refuse(
            "two applications of this run have a <network>\n  help: a robot is in the network once: \
             leave it in one of them",
        );
    }
    if found.is_some() && clock == ClockArgument::Simulated {
        return refuse(
            "other robots do not wait for simulated time\n  help: run with --clock real, or leave \
             <network> out of the application",
        );
    }
    Ok(found)
}
