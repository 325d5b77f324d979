//! Finding a library by the name that a profile gives: `Camera.dll`, `libcamera.so` or `camera`.

use std::path::{Component, Path, PathBuf};

use super::LibraryError;

/// Where libraries are looked for, in order.
#[derive(Debug, Clone, Default)]
pub struct LibrarySearch {
    directories: Vec<PathBuf>,
}

impl LibrarySearch {
    /// Searches these folders.
    pub fn new(directories: Vec<PathBuf>) -> Self {
        Self { directories }
    }

    /// The same with more folders in front.
    #[must_use]
    pub fn preceded_by(&self, first: impl IntoIterator<Item = PathBuf>) -> Self {
        let mut directories: Vec<PathBuf> = first.into_iter().collect();
        for directory in &self.directories {
            if !directories.contains(directory) {
                directories.push(directory.clone());
            }
        }
        Self { directories }
    }

    /// The file of the library `name`.
    ///
    /// # Errors
    /// If no folder has it, or the name is a path that leads elsewhere.
    pub fn find(&self, name: &str) -> Result<PathBuf, LibraryError> {
        // Profiles from Windows write folders with backslashes; only the file name counts there.
        let name = name.trim().replace('\\', "/");
        let stays_inside = Path::new(&name)
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !stays_inside {
            return Err(LibraryError::OutsideSearchPath(name));
        }
        let candidates = candidates(&name);
        for directory in &self.directories {
            for candidate in &candidates {
                let path = directory.join(candidate);
                if path.is_file() {
                    return Ok(path);
                }
            }
        }
        Err(LibraryError::NotFound {
            name,
            candidates,
            directories: self.directories.clone(),
        })
    }
}

/// The name of a file by which the library `name` is found; none if the name leads into a folder.
pub fn file_name(name: &str) -> Option<String> {
    let name = name.trim();
    let is_plain = !name.is_empty() && !name.contains(['/', '\\', '\0']);
    is_plain.then(|| candidates(name).into_iter().next())?
}

/// File names that `name` may stand for on this machine, the exact one first.
fn candidates(name: &str) -> Vec<String> {
    let path = Path::new(name);
    let known = path
        .extension()
        .and_then(|extension| extension.to_str())
        .is_some_and(|extension| matches!(extension.to_ascii_lowercase().as_str(), "so" | "dll"));
    let stem = if known {
        path.with_extension("").to_string_lossy().into_owned()
    } else {
        name.to_owned()
    };
    let mut found = Vec::new();
    if known && !name.to_ascii_lowercase().ends_with(".dll") {
        found.push(name.to_owned());
    }
    let bare = stem.strip_prefix("lib").unwrap_or(&stem);
    for stem in [stem.as_str(), bare] {
        for spelling in [stem.to_owned(), snake_case(stem)] {
            for candidate in [format!("{spelling}.so"), format!("lib{spelling}.so")] {
                if !found.contains(&candidate) {
                    found.push(candidate);
                }
            }
        }
    }
    found
}

/// `ObstacleAvoidance` and `obstacle-avoidance` as build tools for Rust write it:
/// `obstacle_avoidance`.
fn snake_case(name: &str) -> String {
    let mut text = String::with_capacity(name.len() + 4);
    for (index, letter) in name.chars().enumerate() {
        match letter {
            '-' => text.push('_'),
            letter if letter.is_ascii_uppercase() => {
                if index > 0 && !text.ends_with('_') {
                    text.push('_');
                }
                text.push(letter.to_ascii_lowercase());
            }
            letter => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_real_profiles() {
        let cases: [(&str, &[&str]); 4] = [
            ("libcamera.so", &["libcamera.so", "camera.so"]),
            ("Camera.dll", &["Camera.so", "libCamera.so", "libcamera.so"]),
            ("camera", &["camera.so", "libcamera.so"]),
            (
                "path-planner",
                &["libpath-planner.so", "libpath_planner.so"],
            ),
        ];
        for (name, expected) in cases {
            let found = candidates(name);
            for file in expected {
                assert!(found.contains(&(*file).to_owned()), "{name}: {found:?}");
            }
        }
        assert_eq!(candidates("libcamera.so")[0], "libcamera.so");
    }

    #[test]
    fn a_file_is_named_so_that_it_is_found() {
        for name in ["libcamera.so", "Camera.dll", "camera", "path-planner"] {
            let file = file_name(name).expect("a plain name");
            assert!(candidates(name).contains(&file), "{name}: {file}");
        }
        for name in ["", " ", "vision/camera", "..\\camera.dll", "../camera.so"] {
            assert_eq!(file_name(name), None, "{name}");
        }
    }

    #[test]
    fn a_name_that_leads_elsewhere_is_refused() {
        let search = LibrarySearch::new(vec![PathBuf::from(".")]);
        for name in [
            "../evil.so",
            "/lib/evil.so",
            "a/../../evil.so",
            "..\\evil.dll",
        ] {
            assert!(
                matches!(search.find(name), Err(LibraryError::OutsideSearchPath(_))),
                "{name}"
            );
        }
    }
}
