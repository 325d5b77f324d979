//! What a robot proves its name with: a certificate whose common name is that of the robot, its
//! private key, and the certificate of the authority that has signed those of all robots.
//!
//! Files are looked through before the network is entered: later, a connection that another robot
//! refuses would be tried again and again without a word.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustls::RootCertStore;
use rustls::client::verify_server_cert_signed_by_trust_anchor;
use rustls::crypto::{CryptoProvider, ring};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, UnixTime};
use rustls::server::{ParsedCertificate, WebPkiClientVerifier};
use rustls::sign::CertifiedKey;
use system_model::network::NetworkSecurity;
use thiserror::Error;
use x509_parser::prelude::{FromDer as _, X509Certificate};

/// Certificates and keys have some few KB, and so have chains of them.
const BYTES_MAXIMUM: u64 = 1 << 20;

/// Files that do not prove a robot's name.
#[derive(Debug, Error)]
pub enum BadCredentials {
    /// A file that cannot be read.
    #[error("'{}' cannot be read: {reason}", file.display())]
    Unreadable {
        /// Which.
        file: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// A file that does not hold what it should.
    #[error("'{}' holds no {what}: {reason}; write it as PEM", file.display())]
    Content {
        /// Which.
        file: PathBuf,
        /// What it should hold.
        what: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// A key that belongs to another certificate.
    #[error("'{}' is not the private key of '{}'", key.display(), certificate.display())]
    Key {
        /// File of the key.
        key: PathBuf,
        /// File of the certificate.
        certificate: PathBuf,
    },
    /// A certificate that other robots would refuse.
    #[error(
        "no robot that trusts '{}' would believe '{}': {reason}; a certificate is to be of version \
         3, signed by that authority, valid today, and not an authority's own",
        authority.display(), certificate.display()
    )]
    Untrusted {
        /// File of the authority's certificate.
        authority: PathBuf,
        /// File of the certificate.
        certificate: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A certificate with another name.
    #[error(
        "'{}' is the certificate of '{found}', not of '{robot}': the common name (CN) of a robot's \
         certificate is the robot's name", certificate.display()
    )]
    Name {
        /// File of the certificate.
        certificate: PathBuf,
        /// Its common name.
        found: String,
        /// The robot's.
        robot: String,
    },
}

/// Files that prove a name, read and found to be good.
pub struct Credentials {
    certificate_file: PathBuf,
    certificate: Vec<u8>,
    private_key: Vec<u8>,
    authority: Vec<u8>,
    name: String,
}

impl Credentials {
    /// Reads them, and looks whether other robots would believe them today.
    ///
    /// # Errors
    /// When they would not.
    pub fn read(security: &NetworkSecurity) -> Result<Self, BadCredentials> {
        let [certificate, private_key, authority] = [
            read(&security.certificate)?,
            read(&security.private_key)?,
            read(&security.authority)?,
        ];
        let chain = certificates(&security.certificate, &certificate)?;
        let trusted = certificates(&security.authority, &authority)?;
        let provider = Arc::new(ring::default_provider());
        check_trust(Arc::clone(&provider), security, &chain, trusted)?;
        check_key(&provider, security, &chain, &private_key)?;
        Ok(Self {
            name: common_name(&security.certificate, &chain[0])?,
            certificate_file: security.certificate.clone(),
            certificate,
            private_key,
            authority,
        })
    }

    /// The name that they prove.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether they prove this name.
    ///
    /// # Errors
    /// When they prove another one.
    pub(crate) fn are_of(&self, robot: &str) -> Result<(), BadCredentials> {
        match self.name == robot {
            true => Ok(()),
            false => Err(BadCredentials::Name {
                certificate: self.certificate_file.clone(),
                found: self.name.clone(),
                robot: robot.to_owned(),
            }),
        }
    }

    /// What the files hold: certificate, private key, the authority's certificate.
    pub(crate) fn files(&self) -> [&[u8]; 3] {
        [&self.certificate, &self.private_key, &self.authority]
    }
}

fn read(file: &Path) -> Result<Vec<u8>, BadCredentials> {
    let unreadable = |reason: String| BadCredentials::Unreadable {
        file: file.to_owned(),
        reason,
    };
    let mut content = Vec::new();
    let opened = File::open(file).map_err(|error| unreadable(error.to_string()))?;
    let length = opened.take(BYTES_MAXIMUM + 1).read_to_end(&mut content);
    let length = length.map_err(|error| unreadable(error.to_string()))?;
    match u64::try_from(length) {
        Ok(length) if length <= BYTES_MAXIMUM => Ok(content),
        _ => Err(unreadable(format!(
            "it has more than {BYTES_MAXIMUM} bytes"
        ))),
    }
}

/// At least one.
fn certificates(
    file: &Path,
    content: &[u8],
) -> Result<Vec<CertificateDer<'static>>, BadCredentials> {
    let bad = |reason: String| BadCredentials::Content {
        file: file.to_owned(),
        what: "certificate",
        reason,
    };
    let read: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(content).collect();
    let read = read.map_err(|error| bad(error.to_string()))?;
    match read.is_empty() {
        true => Err(bad("there is no such section in it".to_owned())),
        false => Ok(read),
    }
}

/// As other robots do it: those that this one connects to, and those that connect to it.
fn check_trust(
    provider: Arc<CryptoProvider>,
    security: &NetworkSecurity,
    chain: &[CertificateDer<'static>],
    trusted: Vec<CertificateDer<'static>>,
) -> Result<(), BadCredentials> {
    let mut roots = RootCertStore::empty();
    for authority in trusted {
        roots
            .add(authority)
            .map_err(|error| BadCredentials::Content {
                file: security.authority.clone(),
                what: "certificate of an authority",
                reason: error.to_string(),
            })?;
    }
    let untrusted = |reason: String| BadCredentials::Untrusted {
        authority: security.authority.clone(),
        certificate: security.certificate.clone(),
        reason,
    };
    let algorithms = provider.signature_verification_algorithms.all;
    let roots = Arc::new(roots);
    let verifier = WebPkiClientVerifier::builder_with_provider(Arc::clone(&roots), provider);
    let verifier = verifier
        .build()
        .map_err(|error| untrusted(error.to_string()))?;
    let (own, between) = (&chain[0], &chain[1..]);
    let now = UnixTime::now();
    let as_client = verifier.verify_client_cert(own, between, now).map(drop);
    let as_server = || {
        let own = ParsedCertificate::try_from(own)?;
        verify_server_cert_signed_by_trust_anchor(&own, &roots, between, now, algorithms)
    };
    let believed = as_client.and_then(|()| as_server());
    believed.map_err(|error| untrusted(error.to_string()))
}

fn check_key(
    provider: &CryptoProvider,
    security: &NetworkSecurity,
    chain: &[CertificateDer<'static>],
    private_key: &[u8],
) -> Result<(), BadCredentials> {
    let bad = |reason: String| BadCredentials::Content {
        file: security.private_key.clone(),
        what: "private key",
        reason,
    };
    let key = PrivateKeyDer::from_pem_slice(private_key);
    let key = key.map_err(|error| bad(error.to_string()))?;
    let key = provider.key_provider.load_private_key(key);
    let key = key.map_err(|error| bad(error.to_string()))?;
    let certified = CertifiedKey::new(chain.to_vec(), key);
    certified.keys_match().map_err(|_| BadCredentials::Key {
        key: security.private_key.clone(),
        certificate: security.certificate.clone(),
    })
}

fn common_name(file: &Path, certificate: &CertificateDer<'_>) -> Result<String, BadCredentials> {
    let bad = |reason: String| BadCredentials::Content {
        file: file.to_owned(),
        what: "certificate with a common name (CN)",
        reason,
    };
    let (_, parsed) =
        X509Certificate::from_der(certificate).map_err(|error| bad(error.to_string()))?;
    let mut names = parsed.subject.iter_common_name();
    let name = names.next().and_then(|name| name.as_str().ok());
    name.map(str::to_owned)
        .ok_or_else(|| bad("its subject has none".to_owned()))
}
