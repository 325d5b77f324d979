//! Markup that is well-formed by the way it is made, as XML and as HTML, whatever the texts in it
//! say: names and messages come from components and files, and none of them is trusted.

use std::fmt::{self, Display, Write};

/// An attribute: its name, and its value before escaping.
pub(super) type Attribute<'value> = (&'static str, &'value dyn Display);

/// Elements that end where they begin, in HTML; those of SVG may.
const VOID: [&str; 10] = [
    "meta", "img", "br", "col", "line", "rect", "circle", "path", "polyline", "polygon",
];

/// A text of markup that grows.
#[derive(Debug, Default)]
pub(super) struct Markup {
    text: String,
}

impl Markup {
    /// An element with what `content` puts into it.
    pub(super) fn element(
        &mut self,
        name: &'static str,
        attributes: &[Attribute<'_>],
        content: impl FnOnce(&mut Self),
    ) {
        debug_assert!(!VOID.contains(&name), "{name} has no content");
        self.begin(name, attributes);
        self.text.push('>');
        content(self);
        self.text.push_str("</");
        self.text.push_str(name);
        self.text.push('>');
        if !matches!(name, "span" | "code" | "strong" | "a" | "title" | "tspan") {
            self.text.push('\n');
        }
    }

    /// An element with nothing but text.
    pub(super) fn leaf(
        &mut self,
        name: &'static str,
        attributes: &[Attribute<'_>],
        text: impl Display,
    ) {
        self.element(name, attributes, |inside| inside.text(text));
    }

    /// An element that has no content.
    pub(super) fn void(&mut self, name: &'static str, attributes: &[Attribute<'_>]) {
        debug_assert!(VOID.contains(&name), "{name} needs an end");
        self.begin(name, attributes);
        self.text.push_str("/>\n");
    }

    /// A text, escaped.
    pub(super) fn text(&mut self, text: impl Display) {
        // Writing to a text does not fail.
        let _infallible = write!(Escaped(&mut self.text), "{text}");
    }

    /// Style, which is the program's own: it is not escaped.
    pub(super) fn style(&mut self, sheet: &'static str) {
        debug_assert!(!sheet.contains(['<', '&']), "no markup is in it");
        self.text.push_str("<style>\n");
        self.text.push_str(sheet);
        self.text.push_str("</style>\n");
    }

    /// All of it.
    pub(super) fn into_text(self) -> String {
        self.text
    }

    fn begin(&mut self, name: &'static str, attributes: &[Attribute<'_>]) {
        self.text.push('<');
        self.text.push_str(name);
        for (name, value) in attributes {
            self.text.push(' ');
            self.text.push_str(name);
            self.text.push_str("=\"");
            self.text(value);
            self.text.push('"');
        }
    }
}

/// Writes a text so that it is text wherever it stands, in an element or a quoted attribute.
struct Escaped<'text>(&'text mut String);

impl Write for Escaped<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars() {
            match character {
                '&' => self.0.push_str("&amp;"),
                '<' => self.0.push_str("&lt;"),
                '>' => self.0.push_str("&gt;"),
                '"' => self.0.push_str("&quot;"),
                '\'' => self.0.push_str("&#39;"),
                '\n' | '\t' => self.0.push(character),
                // What XML has no room for, and what turns the direction of a text around.
                '\u{FFFE}' | '\u{FFFF}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}' => {
                    self.0.push('\u{FFFD}');
                }
                other if other.is_control() => self.0.push('\u{FFFD}'),
                other => self.0.push(other),
            }
        }
        Ok(())
    }
}

/// A place in a drawing, to a tenth of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pixels(pub(super) f64);

impl Display for Pixels {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:.1}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_stays_a_text() {
        for (text, expected) in [
            ("left_sonar", "left_sonar"),
            (
                "<script>alert(1)</script>",
                "&lt;script&gt;alert(1)&lt;/script&gt;",
            ),
            ("\" onload='x'", "&quot; onload=&#39;x&#39;"),
            ("a&amp;b", "a&amp;amp;b"),
            ("bell\u{7}\u{202E}\u{FFFF}", "bell\u{FFFD}\u{FFFD}\u{FFFD}"),
            ("초음파 센서\n2", "초음파 센서\n2"),
        ] {
            let mut markup = Markup::default();
            markup.leaf("code", &[("title", &text)], text);
            let whole = format!("<code title=\"{expected}\">{expected}</code>");
            assert_eq!(markup.into_text(), whole);
        }
    }

    #[test]
    fn elements_end() {
        let mut markup = Markup::default();
        markup.element("p", &[], |inside| {
            inside.leaf("span", &[], 7);
            inside.void("br", &[]);
        });
        assert_eq!(markup.into_text(), "<p><span>7</span><br/>\n</p>\n");
    }
}
