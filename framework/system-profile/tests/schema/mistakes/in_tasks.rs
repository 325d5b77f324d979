//! One broken task for each rule.

use super::Edit;

pub const MISTAKES: &[Edit] = &[
    ("task.xml", " name=\"follow\"", ""),
    ("task.xml", "class=\"sensor\"", "class=\"sensr\""),
    ("task.xml", " class=\"actuator\"", ""),
    ("task.xml", "threshold=\"0.5\"", "threshold=\"-0.5\""),
    ("task.xml", "essential=\"false\"", "essential=\"no\""),
    (
        "task.xml",
        "name=\"camera\" class",
        "name=\"cam era\" class",
    ),
    (
        "task.xml",
        "name=\"camera\" class",
        "name=\"R1:camera\" class",
    ),
    (
        "task.xml",
        "<component name=\"motor\" class=\"actuator\"/>",
        "",
    ),
    ("task.xml", "<state name=\"there\">", "<state>"),
    ("task.xml", " initial=\"following\"", ""),
    ("task.xml", "event=\"reached\" ", ""),
    ("task.xml", "<run sub_task=\"see\"/>", "<run/>"),
    ("task.xml", "<through component=\"filter\"/>", "<through/>"),
    ("task.xml", "<use component=\"filter\"/><use", "<use"),
    ("task.xml", "amount=\"2\"", "amount=\"two\""),
    ("task.xml", "amount=\"2\"", "amount=\"1e13\""),
    ("task.xml", "<has resource=\"power\"", "<has"),
    (
        "task.xml",
        "<instance component=\"filter\"/>",
        "<instance/>",
    ),
    (
        "task.xml",
        "<instance component=\"filter\"/>",
        "<instanse component=\"filter\"/>",
    ),
    ("task.xml", "functional=\"0.2\"", ""),
    (
        "task.xml",
        "functional_weight=\"0.9\"",
        "functional_weight=\"1.1\"",
    ),
    ("task.xml", "functional_threshold=\"0.2\"", ""),
    ("task.xml", "hops=\"essential\"", "hops=\"esential\""),
    ("task.xml", "running=\"judged\"", "running=\"yes\""),
    ("task.xml", "limit=\"100\"", "limit=\"0\""),
    ("task.xml", "confirm=\"2\"", "confirm=\"0\""),
    ("task.xml", "hysteresis=\"0.1\"", "hysteresis=\"-0.1\""),
    (
        "task.xml",
        "estimation_deadline=\"100ms\"",
        "estimation_deadline=\"0\"",
    ),
    (
        "task.xml",
        "<use component=\"motor\" robot=\"R1\"/>",
        "<use component=\"motor\"/>",
    ),
    (
        "task.xml",
        "measures=\"standard_deviation\"",
        "measures=\"deviation\"",
    ),
    ("task.xml", "window=\"30\"", "window=\"1\""),
    ("task.xml", "scale=\"2\"", "scale=\"0\""),
    ("task.xml", "cycles=\"2\"", "cycles=\"0\""),
    ("task.xml", "by=\"processor_load\"", "by=\"load\""),
    ("task.xml", "<gauge resource=\"power\"", "<gauge"),
    (
        "task.xml",
        "evaluation_period=\"5ms\"",
        "evaluation_period=\"0\"",
    ),
    ("rules.xml", "<adapt task=\"a.xml\"", "<adapt"),
];

/// What only the reader can know, with the reason.
pub const READER_ONLY: &[(&str, Edit)] = &[
    (
        "a name in another file or elsewhere in this one",
        (
            "task.xml",
            "<run sub_task=\"move\"/>",
            "<run sub_task=\"moev\"/>",
        ),
    ),
    (
        "a name in another file or elsewhere in this one",
        (
            "task.xml",
            "robot=\"R2\"/></estimate>",
            "robot=\"R3\"/></estimate>",
        ),
    ),
    (
        "a bound depends on another element's value",
        (
            "task.xml",
            "functional_weight=\"0.9\"",
            "functional_weight=\"0.1\"",
        ),
    ),
    (
        "what an element refers to is of the wrong kind",
        (
            "task.xml",
            "<through component=\"filter\"/>",
            "<through component=\"motor\"/>",
        ),
    ),
    (
        "what an element refers to is of the wrong kind",
        ("task.xml", "<link from=\"camera\"", "<link from=\"filter\""),
    ),
    (
        "a second element among any number of others",
        (
            "task.xml",
            "<instance component=\"filter\"/>",
            "<instance component=\"filter\"/><instance component=\"filter\"/>",
        ),
    ),
    (
        "what runs is not there, or not all that must",
        (
            "task.xml",
            "<use component=\"camera\" robot=\"R1\"/>",
            "<use component=\"camera\" robot=\"R2\"/>",
        ),
    ),
    (
        "what runs is not there, or not all that must",
        ("task.xml", "<use component=\"camera\" robot=\"R1\"/>", ""),
    ),
    (
        "a state that nothing leads to",
        (
            "task.xml",
            "<transition from=\"following\" event=\"reached\" to=\"there\"/>",
            "",
        ),
    ),
];
