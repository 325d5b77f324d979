//! Certificates made on the spot.

use std::path::PathBuf;

use rcgen::{BasicConstraints, CertificateParams, DnType, IsCa, Issuer, KeyPair, date_time_ymd};
use system_model::network::NetworkSecurity;
use tempfile::TempDir;

/// Signs certificates of robots; their files are gone with it.
pub struct Authority {
    folder: TempDir,
    issuer: Issuer<'static, KeyPair>,
}

impl Authority {
    pub fn new(name: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let mut params = params(name);
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        let key = KeyPair::generate().expect("a key");
        let certificate = params.self_signed(&key).expect("a certificate");
        let file = folder.path().join("authority.crt");
        std::fs::write(file, certificate.pem()).expect("a file");
        Self {
            folder,
            issuer: Issuer::new(params, key),
        }
    }

    /// File with its certificate.
    pub fn file(&self) -> PathBuf {
        self.folder.path().join("authority.crt")
    }

    /// What a robot needs to speak with those that it allows.
    pub fn security(&self, robot: &str, allowed: &[&str]) -> NetworkSecurity {
        self.sign(params(robot), robot, allowed)
    }

    /// What was good long ago.
    pub fn expired(&self, robot: &str) -> NetworkSecurity {
        let mut params = params(robot);
        params.not_before = date_time_ymd(2000, 1, 1);
        params.not_after = date_time_ymd(2001, 1, 1);
        self.sign(params, "expired", &[])
    }

    fn sign(&self, params: CertificateParams, name: &str, allowed: &[&str]) -> NetworkSecurity {
        let key = KeyPair::generate().expect("a key");
        let certificate = params.signed_by(&key, &self.issuer).expect("a certificate");
        let file = |end: &str, content: String| {
            let path = self.folder.path().join(format!("{name}.{end}"));
            std::fs::write(&path, content).expect("a file");
            path
        };
        NetworkSecurity {
            certificate: file("crt", certificate.pem()),
            private_key: file("key", key.serialize_pem()),
            authority: self.file(),
            allowed: allowed.iter().map(|robot| (*robot).to_owned()).collect(),
        }
    }
}

fn params(name: &str) -> CertificateParams {
    let mut params = CertificateParams::new(Vec::new()).expect("no names that could be wrong");
    params.distinguished_name.remove(DnType::CommonName);
    params.distinguished_name.push(DnType::CommonName, name);
    params
}
