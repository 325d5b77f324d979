//! Packages and keys as files.

use std::fs::OpenOptions;
use std::io::{Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};

use container::library::LibrarySearch;
use container::network::this_machine;
use robot_network::package::{BYTES_MAXIMUM, Manifest, Package, SigningKey, TrustedKeys};
use system_model::profile::Profile;
use system_profile::{Document, read_profile};

use crate::commands::exit_code;
use crate::commands::run::{Failed, library_folders, unwritable};

/// Makes a secret key and returns the public one.
pub(super) fn make_key(file: &Path) -> Result<String, Failed> {
    let mut secret = [0; 32];
    let random = std::fs::File::open("/dev/urandom");
    random
        .and_then(|mut random| random.read_exact(&mut secret))
        .map_err(|error| Failed {
            code: exit_code::SYSTEM,
            text: format!("/dev/urandom cannot be read: {error}\n  help: is this a whole system?"),
        })?;
    let digits: String = secret.iter().map(|byte| format!("{byte:02x}")).collect();
    OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(0o600)
        .open(file)
        .and_then(|mut file| writeln!(file, "{digits}"))
        .map_err(|error| unwritable(Some(file), &error))?;
    Ok(SigningKey::from_bytes(&secret).public())
}

/// Seals the component of a profile.
pub(super) fn seal(
    profile: &Path,
    key: &Path,
    output: &Path,
    library_path: &[PathBuf],
) -> Result<Manifest, Failed> {
    let key = SigningKey::parse(&text(key)?).map_err(|error| refused(key, error))?;
    let document = Document::open(profile);
    let Some(Profile::Component(component)) = read_profile(&document) else {
        let mistakes = crate::commands::problems::render(&document.problems(), false);
        let said = format!("no component profile\n{mistakes}");
        return Err(refused(profile, said.trim_end()));
    };
    let beside = profile.parent().map(Path::to_owned);
    let search = LibrarySearch::new(library_folders(library_path)).preceded_by(beside);
    let library = component.environment.library_name.as_ref();
    let library = library.ok_or_else(|| refused(profile, "it names no library"))?;
    let library = search.find(&library.value).map_err(|error| Failed {
        code: exit_code::LIBRARY,
        text: error.to_string(),
    })?;
    let version = component.header.version.as_deref().unwrap_or_default();
    let name = component.header.name.value.as_str();
    let package = Package::new(
        (name, version),
        &this_machine(),
        read(&library)?,
        read(profile)?,
    );
    let bytes = package
        .seal(&key)
        .map_err(|error| refused(profile, error))?;
    write(output, &bytes)?;
    Ok(package.manifest)
}

/// Unpacks what is signed by a trusted key for this machine: `COMPONENT.so` and `COMPONENT.xml`.
pub(super) fn open(bytes: &[u8], trust: &Path, into: &Path) -> Result<Manifest, Failed> {
    let trusted = TrustedKeys::parse(&text(trust)?).map_err(|error| refused(trust, error))?;
    let package = Package::open(bytes, &trusted, &this_machine()).map_err(|error| Failed {
        code: exit_code::REFUSED,
        text: format!("the package is refused: {error}"),
    })?;
    let name = &package.manifest.component;
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
    if name.is_empty() || !name.bytes().all(is_letter) {
        return Err(Failed {
            code: exit_code::REFUSED,
            text: format!(
                "the package is refused: '{name}' is no name for a file\n  help: give the component \
                 a name of letters, digits, `_` and `-`"
            ),
        });
    }
    std::fs::create_dir_all(into).map_err(|error| unwritable(Some(into), &error))?;
    write(&into.join(format!("lib{name}.so")), &package.library)?;
    write(&into.join(format!("{name}.xml")), &package.profile)?;
    Ok(package.manifest)
}

/// A file that is not larger than any package.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Failed> {
    let mut bytes = Vec::new();
    let limit = BYTES_MAXIMUM as u64 + 1;
    std::fs::File::open(path)
        .and_then(|file| file.take(limit).read_to_end(&mut bytes))
        .map_err(|error| Failed {
            code: exit_code::FILE,
            text: format!(
                "{} cannot be read: {error}\n  help: check the name, and that you may read it",
                path.display()
            ),
        })?;
    Ok(bytes)
}

fn text(path: &Path) -> Result<String, Failed> {
    let bytes = read(path)?;
    String::from_utf8(bytes).map_err(|_binary| refused(path, "it is no text"))
}

/// Under another name first: who is interrupted leaves no half of a library behind.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Failed> {
    let mut unfinished = path.as_os_str().to_owned();
    unfinished.push(".unfinished");
    std::fs::write(&unfinished, bytes)
        .and_then(|()| std::fs::rename(&unfinished, path))
        .map_err(|error| unwritable(Some(path), &error))
}

fn refused(path: &Path, reason: impl std::fmt::Display) -> Failed {
    Failed {
        code: exit_code::REFUSED,
        text: format!("{}: {reason}", path.display()),
    }
}
