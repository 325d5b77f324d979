//! Packages and keys as files.

use std::fs::OpenOptions;
use std::io::{Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};

use container::library::{LibrarySearch, file_name};
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

/// The keys that are trusted.
pub(in crate::commands) fn trusted_keys(file: &Path) -> Result<TrustedKeys, Failed> {
    TrustedKeys::parse(&text(file)?).map_err(|error| refused(file, error))
}

/// The package, if one of the keys has signed it for this machine; of a component if one is named.
///
/// # Errors
/// Why it is refused.
pub(in crate::commands) fn checked(
    bytes: &[u8],
    trusted: &TrustedKeys,
    component: Option<&str>,
) -> Result<Package, String> {
    let package = Package::open(bytes, trusted, &this_machine());
    let package = package.map_err(|error| error.to_string())?;
    let name = package.manifest.component.as_str();
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
    if name.is_empty() || !name.bytes().all(is_letter) {
        return Err(format!(
            "'{name}' is no name for a file; give the component a name of letters, digits, `_` and `-`"
        ));
    }
    match component {
        // A robot that is not trusted may send what was signed for another purpose.
        Some(wanted) if wanted != name => Err(format!(
            "it is the package of '{name}', not of '{wanted}'; name the file {name}.sfp"
        )),
        _ => Ok(package),
    }
}

/// Unpacks it: `libCOMPONENT.so`, or what the profile calls the library, and `COMPONENT.xml`.
pub(in crate::commands) fn unpack(package: &Package, into: &Path) -> Result<(), Failed> {
    let name = &package.manifest.component;
    let profile = Document::from_bytes(format!("{name}.xml"), &package.profile);
    let library = match read_profile(&profile) {
        Some(Profile::Component(component)) => component.environment.library_name,
        _ => None,
    };
    let library = library.and_then(|library| file_name(&library.value));
    let library = library.ok_or_else(|| Failed {
        code: exit_code::REFUSED,
        text: format!(
            "the package of '{name}' is refused: its profile names no library, or one in a folder\n  \
             help: write <library_name>lib{name}.so</library_name>, and seal it again"
        ),
    })?;
    std::fs::create_dir_all(into).map_err(|error| unwritable(Some(into), &error))?;
    write(&into.join(library), &package.library)?;
    write(&into.join(format!("{name}.xml")), &package.profile)
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
