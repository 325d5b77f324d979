//! `steadfast package`: components on their way from robot to robot, signed and checked.

pub(super) mod fetch;
pub(super) mod files;

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};
use robot_network::package::Manifest;
use serde_json::json;
use system_model::network::NetworkSecurity;

use super::run::Failed;
use super::{exit_code, manual, output};

/// What `steadfast package` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::PACKAGE)]
pub struct PackageArguments {
    #[command(subcommand)]
    command: PackageCommand,
    /// How the result is written
    #[arg(long, value_enum, global = true, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Subcommand)]
enum PackageCommand {
    /// Make a secret key to sign packages with, and print the public one that robots are to trust
    #[command(after_long_help = manual::PACKAGE)]
    Key {
        /// Where the secret key is written; only its owner may read the file
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Put a component's library and profile into a package, and sign it
    #[command(after_long_help = manual::PACKAGE)]
    Seal {
        /// The profile of the component
        #[arg(value_name = "PROFILE.xml")]
        profile: PathBuf,
        /// File with the secret key
        #[arg(long, value_name = "FILE")]
        key: PathBuf,
        /// Where the package is written, best as COMPONENT.sfp
        #[arg(long, value_name = "FILE.sfp")]
        output: PathBuf,
        /// Also look for the library in this folder; may be given several times
        #[arg(long = "library-path", value_name = "FOLDER")]
        library_path: Vec<PathBuf>,
    },
    /// Check a package, and unpack it if it is signed by a trusted key for this machine
    #[command(after_long_help = manual::PACKAGE)]
    Open {
        /// The package
        #[arg(value_name = "FILE.sfp")]
        package: PathBuf,
        #[command(flatten)]
        receiver: Receiver,
    },
    /// Fetch a component from another robot over the network, check it and unpack it
    #[command(after_long_help = manual::PACKAGE)]
    Fetch {
        /// The component, by the name of its package
        #[arg(value_name = "COMPONENT")]
        component: String,
        /// The robot that has it
        #[arg(long, value_name = "ROBOT")]
        from: String,
        /// Its address, like tcp/192.168.0.2:7447, or with certificates tls/192.168.0.2:7447
        #[arg(long, value_name = "ADDRESS")]
        connect: String,
        #[command(flatten)]
        credentials: Option<CredentialFiles>,
        #[command(flatten)]
        receiver: Receiver,
    },
}

/// What proves to a robot with secured connections who asks. The common name of the certificate is
/// one of its own, which the robot allows.
#[derive(Debug, Args)]
struct CredentialFiles {
    /// File with a certificate that the robots' authority has signed, for an address like tls/192.168.0.2:7447
    #[arg(long, required = false, value_name = "FILE", requires_all = ["private_key", "authority"])]
    certificate: PathBuf,
    /// File with the certificate's private key
    #[arg(long, required = false, value_name = "FILE", requires_all = ["certificate", "authority"])]
    private_key: PathBuf,
    /// File with the authority's certificate
    #[arg(long, required = false, value_name = "FILE", requires_all = ["certificate", "private_key"])]
    authority: PathBuf,
}

impl CredentialFiles {
    /// What is needed to speak with one robot.
    fn to_speak_with(&self, robot: &str) -> NetworkSecurity {
        NetworkSecurity {
            certificate: self.certificate.clone(),
            private_key: self.private_key.clone(),
            authority: self.authority.clone(),
            allowed: vec![robot.to_owned()],
        }
    }
}

/// Who takes a package, and where to.
#[derive(Debug, Args)]
struct Receiver {
    /// File with the public keys that are trusted, one a line
    #[arg(long, value_name = "FILE")]
    trust: PathBuf,
    /// Folder for library and profile
    #[arg(long, value_name = "FOLDER")]
    into: PathBuf,
}

/// How the result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: a line
    Text,
    /// For programs: one JSON object
    Json,
}

/// Does it; what was refused is said on standard error.
pub fn run(arguments: &PackageArguments) -> ExitCode {
    let done = match &arguments.command {
        PackageCommand::Key { file } => files::make_key(file).map(|public| {
            let text = format!("{public}\n");
            (text, json!({"public_key": public}))
        }),
        PackageCommand::Seal {
            profile,
            key,
            output,
            library_path,
        } => files::seal(profile, key, output, library_path).map(|it| said("sealed", &it)),
        PackageCommand::Open { package, receiver } => {
            let bytes = files::read(package);
            bytes.and_then(|bytes| receiver.take(&bytes, None))
        }
        PackageCommand::Fetch {
            component,
            from,
            connect,
            credentials,
            receiver,
        } => {
            let security = credentials.as_ref().map(|files| files.to_speak_with(from));
            let bytes = fetch::fetch(component, from, connect, security);
            bytes.and_then(|bytes| receiver.take(&bytes, Some(component)))
        }
    };
    let (text, json) = match done {
        Ok(done) => done,
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            return ExitCode::from(failed.code);
        }
    };
    let text = match arguments.format {
        Format::Text => text,
        Format::Json => format!("{json:#}\n"),
    };
    let written = io::stdout().lock().write_all(text.as_bytes());
    output::finish("package", written, exit_code::DONE)
}

impl Receiver {
    fn take(
        &self,
        bytes: &[u8],
        component: Option<&str>,
    ) -> Result<(String, serde_json::Value), Failed> {
        let trusted = files::trusted_keys(&self.trust)?;
        let package = files::checked(bytes, &trusted, component).map_err(|reason| Failed {
            code: exit_code::REFUSED,
            text: format!("the package is refused: {reason}"),
        })?;
        files::unpack(&package, &self.into)?;
        Ok(said("unpacked", &package.manifest))
    }
}

/// What was done with a package, for people and for programs.
fn said(done: &str, manifest: &Manifest) -> (String, serde_json::Value) {
    let text = format!(
        "{done}: {} {} for {}, ABI {}, library {}\n",
        manifest.component,
        manifest.version,
        manifest.architecture,
        manifest.abi,
        manifest.library_sha256
    );
    (text, json!({"done": done, "manifest": manifest}))
}
