//! A component on its way to a robot that lacks it: library and profile in one file, signed.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | `SFP1` |
//! | 4 | length of the manifest |
//! | 64 | Ed25519 signature of the manifest |
//! | m | manifest, JSON: what is in the package, for which machines, with SHA-256 of each part |
//! | l | library |
//! | p | profile |
//!
//! Lengths are little endian. [`Package::open`] believes nothing that is not signed by a key that
//! the receiver trusts, and looks at the signature first; architecture and ABI come next, because a
//! robot of another kind may well have signed rightly; then the parts must be those of the manifest.

mod keys;

use ed25519_dalek::{Signature, Signer};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

pub use keys::{BadKey, SigningKey, TrustedKeys};

const MARK: [u8; 4] = *b"SFP1";
const FIXED_LENGTH: usize = 4 + 4 + 64;
/// A manifest has some 400 bytes.
const MANIFEST_MAXIMUM: usize = 64 << 10;
/// The largest library of a debug build has 40 MB.
pub const BYTES_MAXIMUM: usize = 128 << 20;

/// What a package says of itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name of the component.
    pub component: String,
    /// Its version, as a person reads it.
    pub version: String,
    /// Architecture that the library is built for, as in `x86_64-linux`.
    pub architecture: String,
    /// Version of the contract between container and components that it was built with.
    pub abi: u32,
    /// Bytes of the library.
    pub library_bytes: u64,
    /// SHA-256 of the library, in hexadecimal digits.
    pub library_sha256: String,
    /// Bytes of the profile.
    pub profile_bytes: u64,
    /// SHA-256 of the profile.
    pub profile_sha256: String,
}

/// The machine that would run what is in a package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// Its architecture, as in `x86_64-linux`.
    pub architecture: String,
    /// Version of the contract that its container keeps.
    pub abi: u32,
}

/// A package whose word can be taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Package {
    /// What it says of itself.
    pub manifest: Manifest,
    /// The library.
    pub library: Vec<u8>,
    /// The profile.
    pub profile: Vec<u8>,
}

/// A package that is not taken, and why.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Refusal {
    /// It is no package.
    #[error("it is no package of a component")]
    Foreign,
    /// It ends early.
    #[error("it was cut short: {found} bytes of {expected}; send it again")]
    CutShort {
        /// Bytes that there are.
        found: u64,
        /// Bytes that it should have.
        expected: u64,
    },
    /// It has more than it should.
    #[error("it is too large: {0} bytes")]
    TooLarge(u64),
    /// Nobody whom the receiver trusts has signed it.
    #[error(
        "no key that this robot trusts has signed it, or it was tampered with after that; add the \
         sender's public key to the trusted ones, or sign it"
    )]
    NotSigned,
    /// A part is not the one that was signed.
    #[error("its {0} was tampered with: it is not the one that was signed")]
    Tampered(&'static str),
    /// It says something of itself that makes no sense.
    #[error("its manifest cannot be understood: {0}")]
    Manifest(String),
    /// It is built for another machine.
    #[error("it is built for {found}, this robot is {expected}; build it for {expected}")]
    Architecture {
        /// Of the package.
        found: String,
        /// Of the robot.
        expected: String,
    },
    /// It is built with another version of the contract.
    #[error("it is built with version {found} of the ABI, this robot has {expected}")]
    Abi {
        /// Of the package.
        found: u32,
        /// Of the robot.
        expected: u32,
    },
}

/// SHA-256 in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Package {
    /// A package of a component that was built for this machine.
    pub fn new(
        (component, version): (&str, &str),
        machine: &Machine,
        library: Vec<u8>,
        profile: Vec<u8>,
    ) -> Self {
        let manifest = Manifest {
            component: component.to_owned(),
            version: version.to_owned(),
            architecture: machine.architecture.clone(),
            abi: machine.abi,
            library_bytes: library.len() as u64,
            library_sha256: sha256(&library),
            profile_bytes: profile.len() as u64,
            profile_sha256: sha256(&profile),
        };
        Self {
            manifest,
            library,
            profile,
        }
    }

    /// The package as bytes, signed.
    ///
    /// # Errors
    /// When it is too large to be taken by anybody.
    pub fn seal(&self, key: &SigningKey) -> Result<Vec<u8>, Refusal> {
        let manifest = serde_json::to_vec(&self.manifest)
            .map_err(|error| Refusal::Manifest(error.to_string()))?;
        let signature = key.0.sign(&manifest);
        let length = FIXED_LENGTH + manifest.len() + self.library.len() + self.profile.len();
        if length > BYTES_MAXIMUM || manifest.len() > MANIFEST_MAXIMUM {
            return Err(Refusal::TooLarge(length as u64));
        }
        let mut bytes = Vec::with_capacity(length);
        bytes.extend_from_slice(&MARK);
        bytes.extend_from_slice(&(manifest.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&signature.to_bytes());
        bytes.extend_from_slice(&manifest);
        bytes.extend_from_slice(&self.library);
        bytes.extend_from_slice(&self.profile);
        Ok(bytes)
    }

    /// Takes a package apart that one of these keys has signed for this machine.
    ///
    /// # Errors
    /// When anything about it is not as it should be.
    pub fn open(bytes: &[u8], trusted: &TrustedKeys, machine: &Machine) -> Result<Self, Refusal> {
        let (manifest, parts) = signed_manifest(bytes, trusted)?;
        let manifest: Manifest = serde_json::from_slice(manifest)
            .map_err(|error| Refusal::Manifest(error.to_string()))?;
        if manifest.architecture != machine.architecture {
            return Err(Refusal::Architecture {
                found: manifest.architecture,
                expected: machine.architecture.clone(),
            });
        }
        if manifest.abi != machine.abi {
            return Err(Refusal::Abi {
                found: manifest.abi,
                expected: machine.abi,
            });
        }
        let expected = manifest
            .library_bytes
            .saturating_add(manifest.profile_bytes);
        if expected > BYTES_MAXIMUM as u64 {
            return Err(Refusal::TooLarge(expected));
        }
        match (parts.len() as u64).cmp(&expected) {
            std::cmp::Ordering::Less => {
                return Err(Refusal::CutShort {
                    found: parts.len() as u64,
                    expected,
                });
            }
            std::cmp::Ordering::Greater => return Err(Refusal::TooLarge(bytes.len() as u64)),
            std::cmp::Ordering::Equal => {}
        }
        let (library, profile) = parts.split_at(manifest.library_bytes as usize);
        if sha256(library) != manifest.library_sha256 {
            return Err(Refusal::Tampered("library"));
        }
        if sha256(profile) != manifest.profile_sha256 {
            return Err(Refusal::Tampered("profile"));
        }
        Ok(Self {
            manifest,
            library: library.to_vec(),
            profile: profile.to_vec(),
        })
    }
}

/// The manifest, if it is signed, and what is behind it.
fn signed_manifest<'bytes>(
    bytes: &'bytes [u8],
    trusted: &TrustedKeys,
) -> Result<(&'bytes [u8], &'bytes [u8]), Refusal> {
    if bytes.len() > BYTES_MAXIMUM {
        return Err(Refusal::TooLarge(bytes.len() as u64));
    }
    if !bytes.starts_with(&MARK) {
        return Err(Refusal::Foreign);
    }
    let short = |expected: usize| Refusal::CutShort {
        found: bytes.len() as u64,
        expected: expected as u64,
    };
    let (fixed, rest) = bytes
        .split_at_checked(FIXED_LENGTH)
        .ok_or_else(|| short(FIXED_LENGTH))?;
    let mut length = [0; 4];
    length.copy_from_slice(&fixed[4..8]);
    let length = u32::from_le_bytes(length) as usize;
    if length > MANIFEST_MAXIMUM {
        return Err(Refusal::Manifest(format!("it has {length} bytes")));
    }
    let (manifest, parts) = rest
        .split_at_checked(length)
        .ok_or_else(|| short(FIXED_LENGTH + length))?;
    let mut signature = [0; 64];
    signature.copy_from_slice(&fixed[8..]);
    match trusted.verify(manifest, &Signature::from_bytes(&signature)) {
        true => Ok((manifest, parts)),
        false => Err(Refusal::NotSigned),
    }
}

#[cfg(test)]
mod tests;
