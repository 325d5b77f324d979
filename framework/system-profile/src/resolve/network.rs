//! `<network>`: the ports that lead into it are there, and of the right kind.

use std::fs::File;
use std::path::{Path, PathBuf};

use system_model::network::{NetworkSecurity, NetworkSpecification, RemoteInput};
use system_model::profile::{ConnectionEnd, Located, NetworkProfile};
use system_model::specification::{PortDirection, PortKind, PortReference};

use super::Assembly;
use super::instances::Scope;
use crate::problem::Severity;
use crate::suggest::quoted;

impl Assembly<'_> {
    /// Resolves the ports of a network, and its files and folder, which are given from `beside`.
    /// Call it while the connections are at hand.
    pub(super) fn network(
        &self,
        scope: &Scope,
        profile: &NetworkProfile,
        beside: &Path,
    ) -> NetworkSpecification {
        let offers = profile.offers.iter();
        let offers = offers.filter_map(|end| self.remote_port(scope, end, PortDirection::Output));
        let inputs = profile.connections.iter().filter_map(|connection| {
            let target = self.remote_port(scope, &connection.target, PortDirection::Input)?;
            Some(RemoteInput {
                robot: connection.robot.value.clone(),
                component: connection.source.component.value.clone(),
                port: connection.source.port.value.clone(),
                target,
            })
        });
        NetworkSpecification {
            robot: profile.robot.value.clone(),
            listen: profile.listen.clone(),
            connect: profile.connect.clone(),
            scouting: profile.scouting,
            silence_limit: profile.silence_limit,
            security: security(scope, profile, beside),
            packages: profile.packages.as_ref().map(|folder| beside.join(folder)),
            offers: offers.collect(),
            remote_inputs: inputs.collect(),
        }
    }

    /// A data port that faces this way; an input that nothing else feeds.
    fn remote_port(
        &self,
        scope: &Scope,
        end: &ConnectionEnd,
        direction: PortDirection,
    ) -> Option<PortReference> {
        let port = self.port(scope, end)?;
        let report = |message: String, help: &str| {
            let document = &scope.file.document;
            document.report(Severity::Error, &end.port, message, Some(help.to_owned()));
        };
        if (port.kind, port.direction) != (PortKind::Data, direction) {
            report(
                format!("the port {} is {}", quoted(&port.name), port.description()),
                "data outputs are offered to other robots, data inputs are fed by them",
            );
            return None;
        }
        let reference = PortReference {
            component: port.component,
            port: port.name,
        };
        let mut wires = self.wires.iter();
        if direction == PortDirection::Input
            && wires.any(|wire| wire.connection.target == reference)
        {
            report(
                format!(
                    "{} has a writer on this robot already",
                    quoted(&reference.port)
                ),
                "an input is fed by this robot or by others; remove one of the two connections",
            );
            return None;
        }
        Some(reference)
    }
}

fn security(scope: &Scope, profile: &NetworkProfile, beside: &Path) -> Option<NetworkSecurity> {
    let tls = profile.tls.as_ref()?;
    let robots = profile.allowed.iter().map(|robot| robot.value.clone());
    let [certificate, private_key, authority] = [
        (&tls.certificate, "the certificate of this robot"),
        (&tls.private_key, "its private key"),
        (
            &tls.authority,
            "the certificate of the authority that has signed those of all robots",
        ),
    ]
    .map(|(file, meaning)| readable(scope, file, meaning, beside));
    Some(NetworkSecurity {
        certificate,
        private_key,
        authority,
        allowed: robots.collect(),
    })
}

/// A file, given from `beside`, that can be read; what it holds is seen when the network is entered.
fn readable(scope: &Scope, file: &Located<String>, meaning: &str, beside: &Path) -> PathBuf {
    let path = beside.join(&file.value);
    let opened = File::open(&path).and_then(|file| file.metadata());
    let reason = match opened {
        Ok(metadata) if metadata.is_file() => return path,
        Ok(_) => "it is no file".to_owned(),
        Err(error) => error.to_string(),
    };
    scope.file.document.report(
        Severity::Error,
        file,
        format!("`{}` cannot be read: {reason}", quoted(&file.value)),
        Some(format!(
            "this is to be {meaning}, as PEM, given from the folder of this file; looked for {}",
            path.display()
        )),
    );
    path
}
