//! Reports: every fault of a run is on the page, and a browser shows it without a complaint.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use system_profile::Document;
use tests::{Application, Finished, Member, Watched, artifacts, assert_html, repository};

/// A page is made in less than a second; a busy machine gets more.
const LIMIT: Duration = Duration::from_secs(60);

/// A browser starts in a second or two.
const BROWSER_LIMIT: Duration = Duration::from_secs(120);

/// Where it is set there must be a browser.
const REQUIRED: &str = "REQUIRE_CHROMIUM";

fn report(folder: &Path, arguments: &[&str]) -> Finished {
    let mut command = Command::new(artifacts().join("steadfast"));
    command.current_dir(folder).arg("report").args(arguments);
    Watched::spawn(&mut command).wait(LIMIT)
}

/// The reference robot with an unplugged sonar, a crash and a hang, and the report of that.
fn robot() -> (Application, Vec<u64>) {
    let application = Application::new();
    let injections = application.write(
        "faults.xml",
        "<fault_injections application='target_following'>
           <inject at='1s' component='left_sonar' fault='unplug_sonar'/>
           <inject at='2s' component='obstacle_avoidance' fault='segfault'/>
           <inject at='3s' component='obstacle_avoidance' port='obstacles' fault='drop' for='1s'/>
         </fault_injections>",
    );
    let rules = repository().join("rules/target_following.xml");
    let path = |name: &str| application.folder().join(name).display().to_string();
    let [rules, injections] = [rules, injections].map(|it| it.display().to_string());
    let (recording, picture) = (path("run.mcap"), path("drive.svg"));
    let profile = repository().join("profiles/applications/target_following.xml");
    let arguments = [
        "--clock",
        "simulated",
        "--for",
        "5s",
        "--rules",
        &rules,
        "--inject",
        &injections,
        "--record",
        &recording,
        "--picture",
        &picture,
    ];
    let outcome = application.run_file(&profile, &arguments).ended_well();
    let mut ids: Vec<u64> = (outcome.verdicts().iter())
        .filter_map(|verdict| verdict["id"].as_u64())
        .collect();
    ids.sort_unstable();
    ids.dedup();
    (application, ids)
}

#[test]
fn every_fault_is_on_the_page() {
    let (application, ids) = robot();
    assert!(ids.len() >= 3, "{ids:?}");
    let folder = application.folder();
    let finished = report(
        folder,
        &[
            "events.jsonl",
            "run.mcap",
            "--summary",
            "summary.json",
            "--picture",
            "drive.svg",
            "--output",
            "report.html",
            "--format",
            "json",
        ],
    );
    assert_eq!(finished.code, Some(0), "{finished}");
    let told: Value = serde_json::from_str(&finished.stdout).expect("JSON");
    assert_eq!(told["runs"].as_array().map(Vec::len), Some(1), "one run");
    let faults = told["runs"][0]["faults"].as_array().expect("faults");
    assert_eq!(faults.len(), ids.len());
    let sonar = faults.iter().filter(|it| it["component"] == "left_sonar");
    assert!(
        sonar.clone().count() > 0 && sonar.clone().all(|it| it["plotted"] == true),
        "{faults:?}"
    );

    let page = std::fs::read_to_string(folder.join("report.html")).expect("the page");
    for id in &ids {
        assert_eq!(
            page.matches(&format!("data-verdict=\"{id}\"")).count(),
            1,
            "{id}"
        );
    }
    let markup = page.split_once('\n').expect("a document type").1;
    let document = Document::from_bytes("report.html", markup.as_bytes());
    assert!(document.tree().is_some(), "{:?}", document.problems());

    assert_html(&folder.join("report.html"));

    if let Some(browser) = browser(folder) {
        let shown = browser.open(&folder.join("report.html"));
        for id in &ids {
            assert!(shown.contains(&format!("data-verdict=\"{id}\"")), "{id}");
        }
        assert_eq!(shown.matches("<article").count(), ids.len());
    }
}

#[test]
fn what_components_say_stays_text_in_a_browser() {
    let application = Application::new()
        .with(&Member::new("counter", "counter"))
        .injections("<inject at='300ms' component='counter' fault='panic'/>");
    let _outcome = application.simulate("1s").ended_well();
    let folder = application.folder();
    let events = std::fs::read_to_string(folder.join("events.jsonl")).expect("events");
    let hostile = "</code><script>console.log('run')</script><img src='http://127.0.0.1:1/x'/>";
    let events = events.replace(
        "\"component\":\"counter\"",
        &format!("\"component\":\"{hostile}\""),
    );
    application.write("events.jsonl", events);
    let finished = report(folder, &["events.jsonl", "--output", "report.html"]);
    assert_eq!(finished.code, Some(0), "{finished}");
    if let Some(browser) = browser(folder) {
        let shown = browser.open(&folder.join("report.html"));
        assert!(
            !shown.contains("<script") && !shown.contains("<img"),
            "{shown}"
        );
        assert!(shown.contains("&lt;script&gt;"), "{shown}");
    }
}

#[test]
fn what_cannot_be_reported_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let event = "{\"t_ns\":7,\"event\":\"notice\",\"message\":\"low battery\"}\n";
    std::fs::write(folder.join("events.jsonl"), event).expect("a file");
    std::fs::write(folder.join("house.xml"), "<package_profile/>").expect("a file");
    std::fs::write(folder.join("summary.json"), "{}").expect("a file");
    let summaries = ["--summary", "summary.json", "--summary", "summary.json"];
    for (arguments, code, words) in [
        (&["nowhere.jsonl"][..], 2, "nowhere.jsonl cannot be read"),
        (&["house.xml"], 1, "house.xml has no event in line 1"),
        (
            &["events.jsonl", "--picture", "summary.json"],
            1,
            "is no SVG picture",
        ),
        (
            &["events.jsonl", "--summary", "house.xml"],
            1,
            "is no summary",
        ),
        (
            &["events.jsonl", "--output", "/proc/nowhere.html"],
            2,
            "cannot be written",
        ),
        (
            &[&["events.jsonl"], &summaries[..]].concat(),
            64,
            "given 2 times",
        ),
        (&[], 64, "--help"),
    ] {
        let given = ["--output", "report.html"];
        let own: &[&str] = if arguments.contains(&"--output") {
            &[]
        } else {
            &given
        };
        let finished = report(folder, &[arguments, own].concat());
        assert_eq!(finished.code, Some(code), "{finished}");
        assert!(finished.stderr.contains(words), "{finished}");
        assert!(finished.stderr.contains("help"), "{finished}");
    }
    let finished = report(folder, &["events.jsonl", "--output", "report.html"]);
    assert_eq!(finished.code, Some(0), "{finished}");
    assert!(finished.stdout.contains("0 faults"), "{finished}");
}

/// A browser without a window.
struct Browser {
    program: &'static str,
    /// Where it keeps what it wants to keep.
    folder: PathBuf,
}

/// The browser, if there is one; that it would notice an error on a page is tried first.
fn browser(folder: &Path) -> Option<Browser> {
    let programs = ["chromium", "chromium-browser", "google-chrome"];
    let works = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    let Some(program) = programs.into_iter().find(works) else {
        assert!(std::env::var_os(REQUIRED).is_none(), "there is no Chromium");
        // Past the test harness, which would keep it to itself.
        let _unread = writeln!(
            std::io::stderr(),
            "LEFT OUT: no report is opened in a browser: there is no Chromium"
        );
        return None;
    };
    let browser = Browser {
        program,
        folder: folder.join("browser"),
    };
    let faulty = folder.join("faulty.html");
    let script = "<!DOCTYPE html><title>x</title><script>no_such_function()</script>";
    std::fs::write(&faulty, script).expect("a file");
    let complaints = browser.dump(&faulty).stderr;
    assert!(
        complaints.contains("CONSOLE"),
        "errors are not noticed: {complaints}"
    );
    Some(browser)
}

impl Browser {
    /// What the browser makes of a page, about which it has no complaint.
    fn open(&self, page: &Path) -> String {
        let finished = self.dump(page);
        assert_eq!(finished.code, Some(0), "{finished}");
        assert!(!finished.stderr.contains("CONSOLE"), "{}", finished.stderr);
        finished.stdout
    }

    fn dump(&self, page: &Path) -> Finished {
        let mut command = Command::new(self.program);
        command
            // Tests may be run by root, in a container without namespaces.
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-dev-shm-usage",
            ])
            .args(["--enable-logging=stderr", "--dump-dom"])
            .arg(format!("--user-data-dir={}", self.folder.display()))
            .arg(format!("file://{}", page.display()));
        Watched::spawn(&mut command).wait(BROWSER_LIMIT)
    }
}
