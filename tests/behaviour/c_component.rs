//! A component in plain C beside components in Rust.

use tests::{Application, Member, c_component};

fn chain() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("filter", "low_pass").own_property("share", "0.5"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "filter.raw")
        .connect("data", "filter.smooth", "recorder.input")
}

#[test]
fn data_go_from_rust_to_c_to_rust() {
    let application = chain();
    c_component(application.folder(), "low_pass.c", "low_pass", &[]);
    let outcome = application.simulate("30ms").ended_well();
    // Each state is half way from the last one to the new number.
    assert_eq!(
        outcome.logs("recorder"),
        [
            "got 1=0.5",
            "got 2=1.25",
            "got 3=2.125",
            "received 3, last 3, gaps 0"
        ]
    );
    assert_eq!(
        outcome.logs("filter"),
        ["sizes: read 401, write 401, unknown port 401", "stopped"]
    );
    assert_eq!(outcome.application()["state"], "ACTIVE");
}

#[test]
fn another_size_or_type_is_refused() {
    for (define, words) in [
        ("PADDED", "'Sample' (24 bytes"),
        ("SAMPLE_NAME=\"Other\"", "'Other'"),
    ] {
        let application = chain();
        c_component(application.folder(), "low_pass.c", "low_pass", &[define]);
        application.simulate("30ms").was_refused(4, &[words]);
    }
}

#[test]
fn a_refusal_in_c_is_told_in_its_own_words() {
    let application =
        Application::new().with(&Member::new("filter", "low_pass").own_property("share", "1.5"));
    c_component(application.folder(), "low_pass.c", "low_pass", &[]);
    application.simulate("30ms").was_refused(
        5,
        &["share must be above 0, at most 1", "402 INPUT_OUT_OF_RANGE"],
    );
}

#[test]
fn data_of_the_wrong_size_are_a_fault_of_who_names_them() {
    let application = chain().rules(
        "<component name='filter'><exception armed='always' severity='ignore'/></component>",
    );
    c_component(application.folder(), "low_pass.c", "low_pass", &[]);
    let outcome = application.simulate("30ms").ended_well();
    let verdicts = outcome.verdicts();
    let sizes = verdicts
        .iter()
        .filter(|verdict| verdict["kind"] == "wrong_size" && verdict["component"] == "filter")
        .map(|verdict| &verdict["evidence"]["size"]);
    let named: Vec<_> = sizes
        .map(|size| (size["port"].as_str(), size["size"].as_u64()))
        .collect();
    assert_eq!(named, [(Some("smooth"), Some(4))], "{verdicts:?}");
    assert_eq!(outcome.application()["state"], "ACTIVE");
}
