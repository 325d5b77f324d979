//! The files of a project, from templates with a few words to fill in.

use std::fs::Permissions;
use std::io;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use system_profile::Schema;

use super::sdk::Sdk;
use crate::commands::exit_code;
use crate::commands::run::Failed;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    RustComponent,
    CComponent,
    Application,
}

/// Signs that mean something in a manifest, a Makefile or a shell script.
const SIGNS: [char; 6] = ['"', '\'', '\\', '$', '`', '@'];

macro_rules! templates {
    ($($file:literal <- $template:literal),* $(,)?) => {
        &[$(($file, include_str!(concat!("../../../templates/", $template, ".template")))),*]
    };
}

/// Path in the project, with `@NAME@` to fill in, and content.
type Template = (&'static str, &'static str);

const RUST_COMPONENT: &[Template] = templates![
    "Cargo.toml" <- "rust_component/Cargo.toml",
    "src/lib.rs" <- "rust_component/lib.rs",
    "src/smoothing.rs" <- "rust_component/smoothing.rs",
    "tests/in_the_container.rs" <- "rust_component/in_the_container.rs",
    "@NAME@.xml" <- "rust_component/profile.xml",
    "alone.xml" <- "rust_component/alone.xml",
    "README.md" <- "rust_component/README.md",
    ".gitignore" <- "rust_component/gitignore",
];

const C_COMPONENT: &[Template] = templates![
    "@NAME@.c" <- "c_component/component.c",
    "Makefile" <- "c_component/Makefile",
    "@NAME@.xml" <- "rust_component/profile.xml",
    "alone.xml" <- "rust_component/alone.xml",
    "README.md" <- "c_component/README.md",
    ".gitignore" <- "c_component/gitignore",
];

const APPLICATION: &[Template] = templates![
    "Cargo.toml" <- "application/Cargo.toml",
    "data/Cargo.toml" <- "application/data.Cargo.toml",
    "data/src/lib.rs" <- "application/data.lib.rs",
    "components/sensor/Cargo.toml" <- "application/component.Cargo.toml",
    "components/sensor/src/lib.rs" <- "application/sensor.lib.rs",
    "components/controller/Cargo.toml" <- "application/component.Cargo.toml",
    "components/controller/src/lib.rs" <- "application/controller.lib.rs",
    "components/controller/src/regulation.rs" <- "application/controller.regulation.rs",
    "profiles/components/sensor.xml" <- "application/sensor.xml",
    "profiles/components/controller.xml" <- "application/controller.xml",
    "profiles/applications/@NAME@.xml" <- "application/application.xml",
    "rules/@NAME@.xml" <- "application/rules.xml",
    "rules/@NAME@_injections.xml" <- "application/injections.xml",
    "test.sh" <- "application/test.sh",
    "README.md" <- "application/README.md",
    ".gitignore" <- "application/gitignore",
    ".vscode/settings.json" <- "application/vscode_settings.json",
];

/// The schema of all files, for editors.
const SCHEMA_FILE: &str = "schema/steadfast.xsd";

impl Kind {
    fn templates(self) -> &'static [Template] {
        match self {
            Self::RustComponent => RUST_COMPONENT,
            Self::CComponent => C_COMPONENT,
            Self::Application => APPLICATION,
        }
    }

    /// What to type next, in the project's folder.
    pub(super) fn next(self) -> &'static [&'static str] {
        match self {
            Self::RustComponent => &["cargo test"],
            Self::CComponent => &["make test"],
            Self::Application => &["./test.sh"],
        }
    }
}

/// Writes a project into a folder that must not be there yet; the names of its files.
pub(super) fn write(
    kind: Kind,
    name: &str,
    sdk: &Sdk,
    folder: &Path,
) -> Result<Vec<String>, Failed> {
    let unwritable = |path: &Path, error: &io::Error| Failed {
        code: exit_code::FILE,
        text: format!(
            "{} cannot be written: {error}\n  help: go to a folder that you may write to",
            path.display()
        ),
    };
    let files = files(kind, name, sdk)?;
    std::fs::create_dir(folder).map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => Failed {
            code: exit_code::REFUSED,
            text: format!(
                "{} is there already, and nothing of it was touched\n  help: choose another name, \
                 or move it away",
                folder.display()
            ),
        },
        _ => unwritable(folder, &error),
    })?;
    for (file, content) in &files {
        let path = folder.join(file);
        write_file(&path, content).map_err(|error| unwritable(&path, &error))?;
    }
    Ok(files.into_iter().map(|(file, _)| file).collect())
}

fn write_file(path: &Path, content: &str) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, content)?;
    if content.starts_with("#!") && path.extension().is_some_and(|ending| ending == "sh") {
        std::fs::set_permissions(path, Permissions::from_mode(0o755))?;
    }
    Ok(())
}

/// All files with their words filled in.
fn files(kind: Kind, name: &str, sdk: &Sdk) -> Result<Vec<(String, String)>, Failed> {
    let executable = std::env::current_exe().unwrap_or_else(|_unknown| "steadfast".into());
    let (sdk_path, include) = (plain(&sdk.rust)?, plain(&sdk.include)?);
    let steadfast = plain(&executable)?;
    let language = match kind {
        Kind::CComponent => "C",
        Kind::RustComponent | Kind::Application => "Rust",
    };
    let fill = |template: &str, file: &str| {
        let folder = file.split('/').nth(1).unwrap_or_default();
        template
            .replace("@NAME@", name)
            .replace("@TYPE@", &type_name(name))
            .replace("@COMPONENT@", folder)
            .replace("@LANGUAGE@", language)
            .replace("@SDK@", &sdk_path)
            .replace("@INCLUDE@", &include)
            .replace("@STEADFAST@", &steadfast)
    };
    let templates = kind.templates().iter();
    let mut files: Vec<(String, String)> = templates
        .map(|(file, template)| (file.replace("@NAME@", name), fill(template, file)))
        .collect();
    if kind == Kind::Application {
        let schema = Schema::named("steadfast").map(Schema::text);
        files.push((SCHEMA_FILE.into(), schema.unwrap_or_default()));
    }
    Ok(files)
}

/// A path as it may stand between quotes in every kind of file.
fn plain(path: &Path) -> Result<String, Failed> {
    let text = path.to_str();
    let is_plain = |text: &&str| !text.contains(SIGNS) && !text.contains(char::is_control);
    text.filter(is_plain).map(str::to_owned).ok_or_else(|| Failed {
        code: exit_code::FILE,
        text: format!(
            "{} holds a sign that build files cannot hold\n  help: move that folder, or make a link \
             to it with a plain name and give that: --sdk FOLDER",
            path.display()
        ),
    })
}

/// `low_pass` as a type: `LowPass`.
fn type_name(name: &str) -> String {
    let words = name.split('_').map(|word| {
        let mut letters = word.chars();
        let first = letters.next().map(|first| first.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    });
    words.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sdk(path: &str) -> Sdk {
        Sdk {
            rust: path.into(),
            include: "/clone/include".into(),
        }
    }

    #[test]
    fn every_word_is_filled_in() {
        for kind in [Kind::RustComponent, Kind::CComponent, Kind::Application] {
            let files = files(kind, "low_pass", &sdk("/clone/sdk")).expect("files");
            for (file, content) in files {
                assert!(!file.contains('@'), "{file}");
                let left = content.split('@').nth(1).filter(|word| {
                    !word.is_empty() && word.chars().all(|it| it.is_ascii_uppercase())
                });
                assert_eq!(left, None, "{file}");
            }
        }
        assert_eq!(type_name("low_pass2_x"), "LowPass2X");
    }

    #[test]
    fn what_is_there_is_not_touched() {
        let folder = tempfile::tempdir().expect("a folder");
        let failed = write(Kind::CComponent, "a", &sdk("/clone/sdk"), folder.path());
        assert_eq!(failed.expect_err("refused").code, exit_code::REFUSED);
        assert_eq!(
            std::fs::read_dir(folder.path()).expect("a folder").count(),
            0
        );
    }

    #[test]
    fn a_path_that_would_break_a_build_file_is_refused() {
        for path in ["/a\"b", "/a$b", "/a\nb"] {
            let refused = files(Kind::RustComponent, "a", &sdk(path));
            assert_eq!(
                refused.expect_err("refused").code,
                exit_code::FILE,
                "{path}"
            );
        }
    }
}
