//! Where the SDK is that a project builds on: in a clone of Steadfast.

use std::path::{Path, PathBuf};

use super::super::run::Failed;
use crate::commands::exit_code;

/// The folders that a project refers to, absolute.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Sdk {
    /// The crate `component-sdk`.
    pub(super) rust: PathBuf,
    /// The folder of `component.h`.
    pub(super) include: PathBuf,
}

impl Sdk {
    /// The one that is given, or the first one upward from this executable or the current folder.
    pub(super) fn find(given: Option<&Path>) -> Result<Self, Failed> {
        let missing = |text: String| Failed {
            code: exit_code::FILE,
            text,
        };
        if let Some(given) = given {
            return Self::at_or_above(given).ok_or_else(|| {
                missing(format!(
                    "{} holds no SDK: framework/component-sdk is not there\n  help: name a clone of \
                     Steadfast: --sdk ~/steadfast",
                    given.display()
                ))
            });
        }
        let executable = std::env::current_exe().and_then(std::fs::canonicalize).ok();
        let starts = [executable, std::env::current_dir().ok()];
        let found = starts.iter().flatten().find_map(|start| Self::above(start));
        found.ok_or_else(|| {
            missing(
                "the SDK of components is not found: neither this executable nor the current folder \
                 lies in a clone of Steadfast\n  help: say where a clone is: --sdk ~/steadfast"
                    .into(),
            )
        })
    }

    /// In a clone, in its folder `framework`, or in the SDK's own folder.
    fn at_or_above(folder: &Path) -> Option<Self> {
        let folder = std::fs::canonicalize(folder).ok()?;
        let likely = folder.ancestors().take(3);
        likely.into_iter().find_map(Self::of_clone)
    }

    fn above(start: &Path) -> Option<Self> {
        start.ancestors().find_map(Self::of_clone)
    }

    fn of_clone(folder: &Path) -> Option<Self> {
        let framework = folder.join("framework");
        let rust = framework.join("component-sdk");
        let include = framework.join("component-abi/include");
        let whole = rust.join("Cargo.toml").is_file() && include.join("component.h").is_file();
        whole.then_some(Self { rust, include })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clone() -> tempfile::TempDir {
        let clone = tempfile::tempdir().expect("a folder");
        for file in [
            "framework/component-sdk/Cargo.toml",
            "framework/component-abi/include/component.h",
        ] {
            let path = clone.path().join(file);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("folders");
            std::fs::write(path, "").expect("a file");
        }
        clone
    }

    #[test]
    fn the_folder_given_is_a_clone_or_a_part_of_it() {
        let clone = clone();
        for part in ["", "framework", "framework/component-sdk"] {
            let sdk = Sdk::find(Some(&clone.path().join(part))).expect("an SDK");
            assert!(sdk.rust.is_absolute() && sdk.rust.ends_with("framework/component-sdk"));
            assert!(sdk.include.join("component.h").is_file());
        }
    }

    #[test]
    fn what_holds_no_sdk_is_said() {
        let empty = tempfile::tempdir().expect("a folder");
        for folder in [empty.path().to_owned(), empty.path().join("absent")] {
            let failed = Sdk::find(Some(&folder)).expect_err("no SDK");
            assert_eq!(failed.code, exit_code::FILE);
            assert!(
                failed.text.contains("help: name a clone"),
                "{}",
                failed.text
            );
        }
    }

    #[test]
    fn the_executable_of_a_clone_knows_its_sdk() {
        let clone = clone();
        let executable = clone.path().join("target/release/steadfast");
        assert!(Sdk::above(&executable).is_some());
        assert_eq!(Sdk::above(Path::new("/")), None);
    }
}
