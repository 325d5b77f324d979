//! One mistake at a time in the samples: reader and schema refuse it both; the reader alone, where
//! XSD 1.0 cannot say it; or neither, where it is none.

mod in_profiles;
mod in_rules;
mod in_tasks;

use std::path::{Path, PathBuf};

use system_profile::{LoadOptions, check_file};

use crate::samples::{files_in, own};
use crate::xmllint;

/// File, what stands in it, what is written instead.
type Edit = (&'static str, &'static str, &'static str);

/// What only the reader can know, with the reason.
const READER_ONLY: &[(&str, Edit)] = &[
    (
        "a bound depends on another element's value",
        ("pump.xml", "<period>20</period>", "<period>0</period>"),
    ),
    (
        "a bound depends on another attribute's value",
        (
            "garden.xml",
            "tick_deadline_ms=\"5\"",
            "tick_deadline_ms=\"51\"",
        ),
    ),
    (
        "a name must not be another one's",
        ("garden.xml", "<tree name=\"patrol\"", "<tree name=\"pump\""),
    ),
    (
        "what a tree says is not this schema's",
        ("garden.xml", "main=\"Patrol\"", "main=\"Ptrol\""),
    ),
    (
        "a bound depends on another element's value",
        ("pump.xml", "<max>1.5</max>", "<max>-1</max>"),
    ),
    (
        "an attribute belongs to one value of another one",
        (
            "injections.xml",
            "deviation=\"0.1\"",
            "deviation=\"0.1\" side=\"left\"",
        ),
    ),
    (
        "an attribute is needed with one value of another one",
        (
            "injections.xml",
            "<inject fault=\"drop\" component=\"pump\" port=\"flow\"/>",
            "<inject fault=\"drop\" component=\"pump\"/>",
        ),
    ),
    (
        "an attribute is needed with another one",
        ("pump.xml", "persist=\"true\" max_age", "max_age"),
    ),
    (
        "either of two elements: all-groups know no choice",
        ("arena.xml", "<position x_m=\"5\" y_m=\"2\"/>", ""),
    ),
    (
        "either of two elements: all-groups know no choice",
        (
            "arena.xml",
            "<position x_m=\"5\" y_m=\"2\"/>",
            "<position x_m=\"5\" y_m=\"2\"/><region><lowest x_m=\"1\" y_m=\"1\"/><highest x_m=\"2\" y_m=\"2\"/></region>",
        ),
    ),
    (
        "text or an element: mixed content may be neither",
        (
            "rules.xml",
            "<secondary>probe_simple.xml</secondary>",
            "<secondary/>",
        ),
    ),
    (
        "a second element among any number of others",
        (
            "pump.xml",
            "<standby preload=\"loaded\"/>",
            "<standby preload=\"loaded\"/><standby preload=\"loaded\"/>",
        ),
    ),
    (
        "a property that is set again, as public profiles do",
        (
            "probe.xml",
            "<name>probe</name>",
            "<name>probe</name><properties><property name=\"p\">1</property><property name=\"p\">2</property></properties>",
        ),
    ),
    (
        "a name in another file or elsewhere in this one",
        (
            "rules.xml",
            "<component name=\"spare\">",
            "<component name=\"sapre\">",
        ),
    ),
    (
        "a name in another file or elsewhere in this one",
        ("garden.xml", "port_name=\"dry\"", "port_name=\"wet\""),
    ),
    (
        "a name in another file or elsewhere in this one",
        ("garden.xml", "port_name=\"setting\"", "port_name=\"alarm\""),
    ),
    (
        "a name in another file or elsewhere in this one",
        (
            "garden.xml",
            "<offer component_name=\"pump\" port_name=\"flow\"/>",
            "<offer component_name=\"pump\" port_name=\"command\"/>",
        ),
    ),
    (
        "a time of 0, whatever its unit",
        (
            "garden.xml",
            "silence_limit=\"400ms\"",
            "silence_limit=\"0s\"",
        ),
    ),
    (
        "a file that is not there",
        (
            "secured_garden.xml",
            "private_key=\"probe.xml\"",
            "private_key=\"R1.key\"",
        ),
    ),
    (
        "an address depends on another element",
        (
            "secured_garden.xml",
            "listen=\"tls/127.0.0.1:7447 ",
            "listen=\"tcp/127.0.0.1:7447 ",
        ),
    ),
    (
        "an address depends on another element",
        (
            "garden.xml",
            "listen=\"tcp/127.0.0.1:7447 ",
            "listen=\"tls/127.0.0.1:7447 ",
        ),
    ),
    (
        "an element depends on another one",
        (
            "secured_garden.xml",
            "<tls certificate=\"pump.xml\" private_key=\"probe.xml\" authority=\"arena.xml\"/>",
            "",
        ),
    ),
    (
        "whoever feeds an input is allowed",
        ("secured_garden.xml", "<allow robot=\"R2\"/>", ""),
    ),
    (
        "whoever sends a component is allowed",
        (
            "secured_garden.xml",
            "<allow robot=\"R3\"/>",
            "<allow robot=\"R3\"/><fetch component=\"pump\" from=\"R4\" key=\"team.pub\"/>",
        ),
    ),
    (
        "a component is fetched once",
        (
            "garden.xml",
            "<fetch component=\"probe\"",
            "<fetch component=\"pump\"",
        ),
    ),
    (
        "a robot does not ask itself",
        ("garden.xml", "from=\"R-3\"", "from=\"R1\""),
    ),
    (
        "a file that is not there",
        (
            "garden.xml",
            "<reference>triple.xml",
            "<reference>tripel.xml",
        ),
    ),
    (
        "sizes of matrices that must fit each other",
        ("drive.xml", "<b>0; 4</b>", "<b>0; 4; 1</b>"),
    ),
    (
        "a circle of dependencies",
        (
            "rules.xml",
            "<reference>wet/one</reference>",
            "<reference>pump</reference>",
        ),
    ),
    (
        "a time of more than a week, whatever its unit",
        (
            "pump.xml",
            "<recovery deadline=\"2s\"/>",
            "<recovery deadline=\"200h\"/>",
        ),
    ),
    (
        "a budget that never runs out",
        (
            "pump.xml",
            "backoff=\"0\" retry_max=\"2\"",
            "backoff=\"9s\" retry_max=\"9\"",
        ),
    ),
];

/// What looks odd and is right: aliases, any order, blanks, other namespaces.
const RIGHT: &[Edit] = &[
    ("pump.xml", "<min>0</min>", "<range_min> 0 </range_min>"),
    ("pump.xml", "<min>0</min>", "<rang_min>-1e-3</rang_min>"),
    (
        "pump.xml",
        "<watchdog deadline=\"60\"",
        "<watchdog deadline=\" 0.06 s \"",
    ),
    (
        "pump.xml",
        "<watchdog deadline=\"60\"",
        "<watchdog deadline=\"60000 µs\"",
    ),
    (
        "pump.xml",
        "<usage>input</usage><name>command</name>",
        "<name>command</name><usage> input\n</usage>",
    ),
    (
        "pump.xml",
        "<severity>reset</severity>",
        "<x:y xmlns:x=\"urn:x\" z=\"1\"/>",
    ),
    ("pump.xml", "<fsm>", "<layout/><fsm collapsed=\"1\">"),
    (
        "pump.xml",
        "<validation rang_min=\"-1\"",
        "<validity min=\"-1\"/><validation rang_min=\"-1\"",
    ),
    (
        "pump.xml",
        "<min>0</min><max>1.5</max>",
        "<max>+1.5E0</max>",
    ),
    ("pump.xml", "persist=\"true\"", "persist=\"1\""),
    ("probe.xml", "<period/>", ""),
    (
        "probe.xml",
        "<type>aperiodic</type>",
        "<type>passive</type>",
    ),
    (
        "pump.xml",
        "<secondary preload=\"warm\"><reference>pump_simple.xml</reference></secondary>",
        "<secondary>pump_simple.xml</secondary>",
    ),
    (
        "pump.xml",
        "return_code=\"unrecoverable\"",
        "return_code=\"500\"",
    ),
    ("old_garden.xml", "application_profile", "package_profile"),
    ("old_system.xml", "system_profile", "system_config"),
    (
        "pump.xml",
        "<component_profile ",
        "<component_profile xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xsi:noNamespaceSchemaLocation=\"component.xsd\" ",
    ),
    (
        "arena.xml",
        "<world_profile>",
        "<?xml-model href=\"world.xsd\"?><world_profile>",
    ),
    ("injections.xml", "at=\"1s\" for=\"2s\"", "for=\"2s\""),
    ("task.xml", "essential=\"false\"", "essential=\"off\""),
    ("task.xml", "dwell=\"5s\"", "dwell=\"0\""),
];

/// A copy of the samples with each edit made in a copy of its file, which lies beside it.
struct Edited {
    folder: tempfile::TempDir,
    files: Vec<PathBuf>,
}

fn edited<'a>(edits: impl IntoIterator<Item = &'a Edit>) -> Edited {
    let folder = tempfile::tempdir().expect("a folder");
    let trees = files_in(&own(), "tree");
    for file in files_in(&own(), "xml").into_iter().chain(trees) {
        let name = file.file_name().expect("a name");
        std::fs::copy(&file, folder.path().join(name)).expect("a copy");
    }
    let edit = |(number, (file, from, to)): (usize, &Edit)| {
        let text = std::fs::read_to_string(folder.path().join(file)).expect("a sample");
        assert!(text.contains(from), "{file} does not hold {from}");
        let path = folder.path().join(format!("edit_{number}.xml"));
        let count = if is_name(from) { usize::MAX } else { 1 };
        std::fs::write(&path, text.replacen(from, to, count)).expect("a file");
        path
    };
    let files = edits.into_iter().enumerate().map(edit).collect();
    Edited { folder, files }
}

/// A bare name stands in a start tag and in its end tag.
fn is_name(text: &str) -> bool {
    text.chars()
        .all(|letter| letter.is_alphanumeric() || letter == '_')
}

/// What the reader says of a file itself, warnings as well.
fn problems(path: &Path) -> Vec<String> {
    let reports = check_file(path, &LoadOptions::default());
    reports[0]
        .problems
        .iter()
        .map(ToString::to_string)
        .collect()
}

#[test]
fn every_mistake_is_refused_by_reader_and_schema() {
    let mistakes = [
        in_profiles::MISTAKES,
        in_rules::MISTAKES,
        in_tasks::MISTAKES,
    ]
    .concat();
    let edited = edited(&mistakes);
    let schema = xmllint::is_there().then(|| {
        let schema = xmllint::printed(edited.folder.path(), "steadfast");
        xmllint::validate(&schema, &edited.files)
    });
    for (file, edit) in edited.files.iter().zip(&mistakes) {
        assert!(!problems(file).is_empty(), "the reader takes {edit:?}");
        let refused = schema.as_ref().is_none_or(|found| found.contains_key(file));
        assert!(refused, "the schema takes {edit:?}");
    }
}

#[test]
fn what_the_schema_cannot_know_the_reader_does() {
    let reader_only = [READER_ONLY, in_tasks::READER_ONLY].concat();
    let edited = edited(reader_only.iter().map(|(_, edit)| edit));
    let schema = xmllint::is_there().then(|| {
        let schema = xmllint::printed(edited.folder.path(), "steadfast");
        xmllint::validate(&schema, &edited.files)
    });
    for (file, (reason, edit)) in edited.files.iter().zip(&reader_only) {
        assert!(
            !problems(file).is_empty(),
            "the reader takes {edit:?}: {reason}"
        );
        let complaints = schema.as_ref().and_then(|found| found.get(file));
        assert_eq!(complaints, None, "the schema does know {edit:?}");
    }
}

#[test]
fn what_looks_odd_and_is_right_is_taken_by_both() {
    let edited = edited(RIGHT);
    for (file, edit) in edited.files.iter().zip(RIGHT) {
        assert_eq!(problems(file), [""; 0], "{edit:?}");
    }
    if xmllint::is_there() {
        let schema = xmllint::printed(edited.folder.path(), "steadfast");
        let complaints = xmllint::validate(&schema, &edited.files);
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
}
