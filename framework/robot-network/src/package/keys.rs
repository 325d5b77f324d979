//! Keys as people write them: 64 hexadecimal digits a line.

use ed25519_dalek::{Signature, VerifyingKey};
use thiserror::Error;

/// More are not trusted but listed.
const TRUSTED_MAXIMUM: usize = 64;

/// A text that is no key.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum BadKey {
    /// Not 64 hexadecimal digits.
    #[error("line {line} is no key: write 64 hexadecimal digits")]
    Digits {
        /// Counted from 1.
        line: usize,
    },
    /// No point of the curve, or a weak one.
    #[error("line {line} is no public key of Ed25519")]
    Curve {
        /// Counted from 1.
        line: usize,
    },
    /// None at all.
    #[error("there is no key in it")]
    Nothing,
    /// Too many.
    #[error("there are more than {TRUSTED_MAXIMUM} keys")]
    TooMany,
}

/// A secret key, with which packages are signed. Whoever has it is trusted: keep it in a file that
/// nobody else can read.
pub struct SigningKey(pub(super) ed25519_dalek::SigningKey);

/// Public keys of those who may send components.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TrustedKeys(Vec<VerifyingKey>);

impl SigningKey {
    /// A key from 32 bytes that nobody can guess.
    pub fn from_bytes(secret: &[u8; 32]) -> Self {
        Self(ed25519_dalek::SigningKey::from_bytes(secret))
    }

    /// The key in a text; lines that begin with `#` are remarks.
    ///
    /// # Errors
    /// When there is not just one.
    pub fn parse(text: &str) -> Result<Self, BadKey> {
        let mut keys = lines(text);
        let (line, digits) = keys.next().ok_or(BadKey::Nothing)?;
        let secret = bytes(line, digits)?;
        match keys.next() {
            Some(_) => Err(BadKey::TooMany),
            None => Ok(Self::from_bytes(&secret)),
        }
    }

    /// The public key that belongs to it, in hexadecimal digits.
    pub fn public(&self) -> String {
        let public = self.0.verifying_key().to_bytes();
        public.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

impl TrustedKeys {
    /// The keys in a text, one a line; lines that begin with `#` are remarks.
    ///
    /// # Errors
    /// When a line is no key, or there is none.
    pub fn parse(text: &str) -> Result<Self, BadKey> {
        let keys = lines(text).map(|(line, digits)| {
            let key = VerifyingKey::from_bytes(&bytes(line, digits)?);
            let key = key.map_err(|_no_point| BadKey::Curve { line })?;
            match key.is_weak() {
                true => Err(BadKey::Curve { line }),
                false => Ok(key),
            }
        });
        let keys: Vec<VerifyingKey> = keys.take(TRUSTED_MAXIMUM + 1).collect::<Result<_, _>>()?;
        match keys.len() {
            0 => Err(BadKey::Nothing),
            1..=TRUSTED_MAXIMUM => Ok(Self(keys)),
            _ => Err(BadKey::TooMany),
        }
    }

    /// Whether one of them has signed these bytes.
    pub(super) fn verify(&self, bytes: &[u8], signature: &Signature) -> bool {
        let mut keys = self.0.iter();
        keys.any(|key| key.verify_strict(bytes, signature).is_ok())
    }
}

fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = (1..).zip(text.lines().map(str::trim));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

fn bytes(line: usize, digits: &str) -> Result<[u8; 32], BadKey> {
    let bad = BadKey::Digits { line };
    if digits.len() != 64 || !digits.is_ascii() {
        return Err(bad);
    }
    let mut bytes = [0; 32];
    for (byte, index) in bytes.iter_mut().zip((0..64).step_by(2)) {
        let pair = &digits[index..index + 2];
        let is_hexadecimal = pair.bytes().all(|digit| digit.is_ascii_hexdigit());
        *byte = match u8::from_str_radix(pair, 16) {
            Ok(value) if is_hexadecimal => value,
            _ => return Err(bad),
        };
    }
    Ok(bytes)
}
