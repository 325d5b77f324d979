//! `xmllint` as another judge of files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use system_profile::Schema;

/// So many files are validated by one process, well within the longest command line.
const FILES_AT_ONCE: usize = 1000;

/// What is wrong with a file: lines from 1, with words.
pub type Complaints = Vec<(u32, String)>;

/// Whether there is an `xmllint`; one that must be there and is not fails the test.
pub fn is_there() -> bool {
    let found = Command::new("xmllint").arg("--version").output().is_ok();
    let required = std::env::var_os("REQUIRE_XMLLINT").is_some();
    assert!(
        found || !required,
        "xmllint is missing; install the Debian package libxml2-utils"
    );
    if !found {
        eprintln!("skipped: there is no xmllint; install the Debian package libxml2-utils");
    }
    found
}

/// Writes a schema as `steadfast schema` prints it.
pub fn printed(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(format!("{name}.xsd"));
    let schema = Schema::named(name).expect("a schema");
    std::fs::write(&path, schema.text()).expect("a file");
    path
}

/// Complaints about each file that has any.
pub fn validate(schema: &Path, files: &[PathBuf]) -> BTreeMap<PathBuf, Complaints> {
    let mut found: BTreeMap<PathBuf, Complaints> = BTreeMap::new();
    for files in files.chunks(FILES_AT_ONCE) {
        let mut command = Command::new("xmllint");
        command.args(["--nonet", "--noout", "--schema"]).arg(schema);
        let output = command.args(files).output().expect("xmllint runs");
        let text = String::from_utf8_lossy(&output.stderr);
        let judged = |line: &str| line.ends_with(" validates") || line.ends_with(" to validate");
        let judged = text.lines().filter(|line| judged(line)).count();
        assert_eq!(judged, files.len(), "every file is judged: {text}");
        for line in text.lines() {
            let mut parts = line.splitn(3, ':');
            let place = (
                parts.next(),
                parts.next().and_then(|line| line.parse().ok()),
            );
            // The tool's own remark, after an error about the same value.
            let is_remark = line.contains(": Warning: ");
            if let ((Some(file), Some(line)), Some(words), false) = (place, parts.next(), is_remark)
            {
                let complaints = found.entry(file.into()).or_default();
                complaints.push((line, words.trim().to_owned()));
            }
        }
    }
    found
}
