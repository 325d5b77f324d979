//! The application that is measured: a chain of components between two stopwatches, written as the
//! XML files that an integrator would write, into a folder of its own.

use std::io;
use std::path::{Path, PathBuf};

use super::rules::{self, Rules};

/// Period of the chain in ms: 1 kHz, as fast as control loops of robots usually are.
pub(super) const PERIOD_MS: u32 = 1;

/// How the components of a chain are executed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Execution {
    /// All on one thread, in order, in every [`PERIOD_MS`].
    Together,
    /// Each on a thread of its own, with this period in ms.
    Alone(u32),
}

/// What is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain {
    /// Components between the stopwatches.
    pub(super) components: usize,
    /// How they are executed.
    pub(super) execution: Execution,
    /// What the rules ask for.
    pub(super) rules: Rules,
    /// The word of the isolation tier.
    pub(super) tier: &'static str,
    /// Times that each stopwatch keeps.
    pub(super) samples: usize,
}

/// Where the files of a chain are.
#[derive(Debug)]
pub(super) struct Files {
    /// The application.
    pub(super) application: PathBuf,
    /// The rules.
    pub(super) rules: PathBuf,
    /// What the first stopwatch writes when the run ends.
    pub(super) sender: PathBuf,
    /// What the last stopwatch writes when the run ends.
    pub(super) receiver: PathBuf,
}

/// The name of a component of the chain, counted from 0.
pub(super) fn name(number: usize) -> String {
    format!("relay_{number}")
}

/// Writes all files of a chain into a folder.
///
/// # Errors
/// If one cannot be written.
pub(super) fn write(chain: &Chain, folder: &Path) -> io::Result<Files> {
    let files = Files {
        application: folder.join("chain.xml"),
        rules: folder.join("rules.xml"),
        sender: folder.join("sender.txt"),
        receiver: folder.join("receiver.txt"),
    };
    // A standby is of another profile: a component is not its own secondary.
    for (name, library) in [
        ("relay", "relay"),
        ("other_relay", "relay"),
        ("stopwatch", "stopwatch"),
    ] {
        let path = folder.join(format!("{name}.xml"));
        std::fs::write(path, profile(name, library, chain.execution))?;
    }
    std::fs::write(folder.join("model.xml"), rules::MODEL)?;
    std::fs::write(&files.application, application(chain, &files))?;
    std::fs::write(&files.rules, rules::text(chain))?;
    Ok(files)
}

fn application(chain: &Chain, files: &Files) -> String {
    let mut components = stopwatch("sender", chain.samples, &files.sender);
    let mut connections = String::new();
    let mut before = "sender".to_owned();
    for number in 0..chain.components {
        let name = name(number);
        components += &subcomponent(&name, "relay", "");
        connections += &connection(&before, &name);
        before = name;
    }
    components += &stopwatch("receiver", chain.samples, &files.receiver);
    connections += &connection(&before, "receiver");
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<package_profile>\n  <name>chain</name>\n  \
         <subcomponents>\n{components}  </subcomponents>\n  \
         <port_connections>\n{connections}  </port_connections>\n</package_profile>\n"
    )
}

fn stopwatch(name: &str, samples: usize, record: &Path) -> String {
    let properties = format!(
        "<properties><property name=\"samples\" type=\"int\">{samples}</property>\
         <property name=\"record\" type=\"string\">{}</property></properties>",
        record.display()
    );
    subcomponent(name, "stopwatch", &properties)
}

fn subcomponent(name: &str, library: &str, properties: &str) -> String {
    format!(
        "    <subcomponent><name>{name}</name><reference>{library}.xml</reference>{properties}\
         </subcomponent>\n"
    )
}

fn connection(source: &str, target: &str) -> String {
    format!(
        "    <port_connection port_type=\"data\">\
         <source component_name=\"{source}\" port_name=\"output\"/>\
         <target component_name=\"{target}\" port_name=\"input\"/></port_connection>\n"
    )
}

/// The shipped profiles, executed as the chain wants it.
fn profile(name: &str, library: &str, execution: Execution) -> String {
    let (kind, period_ms) = match execution {
        Execution::Together => ("periodic-shared", PERIOD_MS),
        Execution::Alone(period_ms) => ("periodic", period_ms),
    };
    let port = |name: &str, usage: &str| {
        format!(
            "    <data_port><name>{name}</name><usage>{usage}</usage>\
             <data_type>Parcel</data_type></data_port>\n"
        )
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<component_profile>\n  \
         <name>{name}</name>\n  \
         <execution_environment><library_name>lib{library}.so</library_name>\
         </execution_environment>\n  \
         <execution_semantics><type>{kind}</type><period>{period_ms}</period>\
         <priority>50</priority></execution_semantics>\n  \
         <ports>\n{}{}  </ports>\n</component_profile>\n",
        port("input", "input"),
        port("output", "output"),
    )
}
