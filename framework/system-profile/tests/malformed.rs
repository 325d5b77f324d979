//! What is no XML, or too much of it: a clear error at a place, quickly, and never a crash.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use system_profile::parse::{MAX_ATTRIBUTES, MAX_DEPTH, MAX_ELEMENTS};
use system_profile::{Document, MAX_FILE_SIZE, read_profile, reading};

fn malformed(text: &str) -> String {
    let document = Document::from_bytes("f.xml", text.as_bytes());
    let Some(problem) = document.malformed() else {
        return "well-formed".into();
    };
    assert!(problem.help.is_some(), "{text}");
    let message = problem.message.trim_start_matches("not well-formed XML: ");
    format!("{}:{} {message}", problem.place.line, problem.place.column)
}

#[test]
fn each_offence_has_its_place() {
    for (text, expected) in [
        ("", "1:1 the file holds no element"),
        (
            "<?xml version='1.0'?>\n<!-- -->",
            "1:1 the file holds no element",
        ),
        ("<a>\n <b>\n</a>", "3:1 </a> where </b> was expected"),
        ("<a>\n <b>text", "2:3 <b> is never closed"),
        ("<a>\n <b", "2:2 a tag without its `>`"),
        ("</a>", "1:1 </a> closes nothing"),
        ("<a/>\n<b/>", "2:2 a second outermost element <b>"),
        ("<a/>\n text", "2:2 text outside the outermost element"),
        (
            "<a>\n<?xml version='1.0'?></a>",
            "2:1 the XML declaration does not",
        ),
        ("<a t='x<y'/>", "1:8 `<` in the value of an attribute"),
        ("<a t=x/>", "1:6 an attribute value without quotes"),
        ("<a t/>", "1:5 an attribute without `=`"),
        (
            "<a t='1' t='2'/>",
            "1:10 an attribute that the element already has",
        ),
        ("<a t='1'u='2'/>", "1:9 `u` is no attribute"),
        ("<a>1 & 2</a>", "1:6 a bare `&`"),
        ("<a>&nbsp;</a>", "1:4 the reference &nbsp; is not known"),
        ("<a>&#0;</a>", "1:4 the reference &#0; is not known"),
        ("<a t='&nbsp;'/>", "1:7 this value cannot be read"),
        ("<a t='&#1;'/>", "1:7 this value refers to a character"),
        ("<a>]]></a>", "1:4 `]]>` in a text"),
        ("<a><!-- a -- b --></a>", "1:11 `--` in a comment"),
        ("<a>\u{1}</a>", "1:4 the character U+0001 is not allowed"),
        ("<1a/>", "1:2 `1a` is no name of an element"),
        ("<a><!DOCTYPE", "1:4 a DOCTYPE without its `>`"),
        (
            "<a>\n<b t='1></b></a>",
            "2:1 a tag with an attribute value that is never closed",
        ),
        ("<a><!x></a>", "1:4 "),
        ("<?xml?><a/>", "1:1 "),
        ("<a><b <c/></a>", "1:"),
        ("<a", "1:1 a tag"),
        ("<", "1:1 "),
    ] {
        let found = malformed(text);
        assert!(found.starts_with(expected), "{text:?}: {found}");
    }
}

#[test]
fn what_is_well_formed_is_taken() {
    for text in [
        "<a/>",
        "\u{FEFF}<a/>",
        "<?xml version=\"1.0\"?>\r\n<!DOCTYPE a [<!ENTITY b 'c'>]><a/>\n<!-- -->",
        "<a t = \"x>y\" u='&lt;&#x41;'>&amp;&#65;<![CDATA[<b>]]></a >",
        "<안산시 이름='글'/>",
    ] {
        assert_eq!(malformed(text), "well-formed", "{text}");
    }
    let document = Document::from_bytes(
        "f.xml",
        b"<a u='&lt;&#x41;'> &amp;&#65;<![CDATA[<b>]]> </a>",
    );
    let root = document.tree().unwrap();
    assert_eq!(root.text, "&A<b>");
    assert_eq!(root.attribute("u"), Some("<A"));
}

#[test]
fn nesting_elements_and_attributes_are_limited() {
    let started = Instant::now();
    let deepest = MAX_DEPTH;
    let nested = |depth: usize| "<a>".repeat(depth) + &"</a>".repeat(depth);
    assert_eq!(malformed(&nested(deepest)), "well-formed");
    assert!(malformed(&nested(deepest + 1)).contains("in each other"));
    assert!(malformed(&nested(1_000_000)).contains("in each other"));
    assert!(malformed(&"<a>".repeat(1_000_000)).contains("in each other"));
    let many = format!("<a>{}</a>", "<b/>".repeat(MAX_ELEMENTS));
    assert!(malformed(&many).contains("in all"));
    let attributes: String = (0..=MAX_ATTRIBUTES).map(|n| format!(" a{n}=''")).collect();
    assert!(malformed(&format!("<a{attributes}/>")).contains("attributes"));
    assert!(started.elapsed() < Duration::from_secs(20));
}

#[test]
fn a_hundred_megabytes_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.xml");
    let file = std::fs::File::create(&path).unwrap();
    file.set_len(100 * 1024 * 1024).unwrap();
    let document = Document::open(&path);
    assert!(!document.is_readable());
    let problem = &document.problems()[0];
    assert!(problem.message.contains(&MAX_FILE_SIZE.to_string()));
    assert_eq!(problem.place.line, 0);
}

#[test]
fn what_is_no_file_is_not_opened() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().to_owned(), folder.path().join("missing.xml")] {
        let document = Document::open(&path);
        assert!(!document.is_readable());
        assert_eq!(document.problems().len(), 1);
        assert!(read_profile(&document).is_none());
        assert_eq!(reading(&document)["wellformed"], false);
    }
}

#[test]
fn wrong_bytes_in_a_text_are_a_warning() {
    let text = b"<component_profile><name>\xFF</name></component_profile>";
    let document = Document::from_bytes("f.xml", text);
    assert!(document.tree().is_some());
    assert!(!document.has_errors());
    assert_eq!(document.problems()[0].place.column, 26);
}

const PROFILE: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<component_profile><name>한글</name><execution_semantics><type>periodic</type><period>20ms</period>
</execution_semantics><properties><property name="a" type="int">1 &lt; 2</property></properties>
<ports><data_port><name>x</name><usage>input</usage><policy_param name="size">9</policy_param>
</data_port></ports></component_profile>"#;

fn survive(bytes: &[u8]) {
    let document = Document::from_bytes("f.xml", bytes);
    let _profile = read_profile(&document);
    let _reading = reading(&document);
    let length = document
        .problems()
        .iter()
        .map(|problem| problem.length)
        .sum::<usize>();
    assert!(length <= bytes.len() * 101);
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        survive(&bytes);
    }

    #[test]
    fn arbitrary_markup_never_panics(text in "[<>/a-c'\"=&;#! \\[\\]?x1\\-한\u{1}]{0,80}") {
        survive(text.as_bytes());
        survive(format!("<?xml version='1.0' encoding='euc-kr'?><a {text}").as_bytes());
    }

    #[test]
    fn a_damaged_profile_never_panics(
        cut in 0..PROFILE.len(),
        edits in prop::collection::vec((0..PROFILE.len(), any::<u8>()), 0..6),
    ) {
        let mut bytes = PROFILE.as_bytes().to_vec();
        for (at, byte) in edits {
            bytes[at] = byte;
        }
        survive(&bytes);
        survive(&bytes[..cut]);
        survive(&bytes[cut..]);
    }
}
