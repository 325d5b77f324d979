//! Packages of PyPI, by which others read what Steadfast writes.

use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::watchdog::{Watched, repository};

/// Names the interpreter that has the packages; where it is set it must work.
const PYTHON: &str = "STEADFAST_PYTHON";

/// An interpreter that has the package. Without one, and without the variable `STEADFAST_PYTHON`, it says
/// that the test is left out.
///
/// # Panics
/// If the variable is set, and its interpreter lacks the package.
pub fn python(package: &str) -> Option<String> {
    let named = std::env::var(PYTHON).ok();
    let python = named.clone().unwrap_or_else(|| "python3".to_owned());
    let probed = Command::new(&python)
        .args(["-c", &format!("import {package}")])
        .output();
    let works = probed.is_ok_and(|it| it.status.success());
    assert!(
        works || named.is_none(),
        "{PYTHON}={python} has no package '{package}'"
    );
    if !works {
        // Past the test harness, which would keep it to itself.
        let _unread = writeln!(
            std::io::stderr(),
            "LEFT OUT: {python} has no package '{package}' (pip install {package}, or set {PYTHON})"
        );
    }
    works.then_some(python)
}

/// A page of half a megabyte takes three seconds; a busy machine gets more.
const PARSE_LIMIT: Duration = Duration::from_secs(100);

/// A page has no error by the rules of HTML 5, as far as there is a parser that knows them.
///
/// # Panics
/// If it has one.
pub fn assert_html(page: &Path) {
    let Some(python) = python("html5lib") else {
        return;
    };
    let mut command = Command::new(python);
    command
        .arg(repository().join("tests/data/check_page.py"))
        .arg(page);
    let finished = Watched::spawn(&mut command).wait(PARSE_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
}
