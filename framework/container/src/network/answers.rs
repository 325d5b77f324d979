//! What this robot answers when others ask it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use robot_network::message::{ComponentEntry, Database, OfferedPort};
use robot_network::{Answers, package};
use system_model::life_cycle::LifeCycleState;
use system_model::network::NetworkSpecification;
use system_model::specification::ApplicationSpecification;

use super::{library_file, port, this_machine};
use crate::assembly::Assembly;
use crate::status::ComponentStatus;

/// What is known of this robot's components.
pub(super) struct Holdings {
    robot: String,
    /// Folder with sealed packages.
    packages: Option<PathBuf>,
    components: Vec<Holding>,
}

struct Holding {
    name: String,
    type_name: String,
    library: Option<PathBuf>,
    /// Reckoned when somebody asks for the first time.
    sha256: OnceLock<String>,
    status: Arc<ComponentStatus>,
    offers: Vec<OfferedPort>,
}

impl Holdings {
    pub(super) fn new(
        network: &NetworkSpecification,
        application: &ApplicationSpecification,
        assembly: &Assembly,
    ) -> Self {
        let components = application.components.iter().enumerate();
        let components = components.map(|(index, component)| Holding {
            name: component.name.clone(),
            type_name: component.type_name.clone(),
            library: library_file(assembly, index),
            sha256: OnceLock::new(),
            status: Arc::clone(&assembly.statuses[index]),
            offers: network
                .offers
                .iter()
                .filter(|end| end.component == index)
                .filter_map(|end| {
                    let data_type = port(assembly, end)?.1.data_type.as_ref()?;
                    Some(OfferedPort {
                        port: end.port.clone(),
                        data_type: data_type.name.clone(),
                    })
                })
                .collect(),
        });
        Self {
            robot: network.robot.clone(),
            packages: network.packages.clone(),
            components: components.collect(),
        }
    }
}

impl Answers for Holdings {
    fn database(&self) -> Database {
        let components = self.components.iter().map(|holding| ComponentEntry {
            name: holding.name.clone(),
            library: holding.type_name.clone(),
            library_sha256: holding
                .sha256
                .get_or_init(|| checksum(holding.library.as_deref()))
                .clone(),
            runs: holding.status.state() == LifeCycleState::Active,
            offers: holding.offers.clone(),
        });
        let machine = this_machine();
        Database {
            robot: self.robot.clone(),
            architecture: machine.architecture,
            abi: machine.abi,
            components: components.collect(),
        }
    }

    /// The file as it lies there: it was sealed by somebody who has the key, and whoever gets it
    /// believes nothing else.
    fn package(&self, component: &str) -> Option<Vec<u8>> {
        let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
        if component.is_empty() || !component.bytes().all(is_letter) {
            return None;
        }
        let path = self.packages.as_ref()?.join(format!("{component}.sfp"));
        let length = path.metadata().ok()?.len();
        let is_package = length <= package::BYTES_MAXIMUM as u64;
        is_package.then(|| std::fs::read(path).ok())?
    }
}

/// Empty for a file that cannot be read any more.
fn checksum(library: Option<&Path>) -> String {
    let content = library.and_then(|path| std::fs::read(path).ok());
    content.map_or_else(String::new, |content| package::sha256(&content))
}
