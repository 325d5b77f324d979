//! One box with what is written in it.

use std::fmt::Write as _;

use super::super::diagram::Node;
use super::super::layout::{Area, Extent};
use crate::commands::explain::escaped;

/// Size of the name.
const NAME: f64 = 13.0;
/// Size of notes and ports.
const NOTE: f64 = 11.0;
/// Height of a line of notes or ports.
const ROW: f64 = 16.0;
/// Between the border and what is written.
const PADDING: f64 = 9.0;
/// Between the names of an input and of an output in one row.
const BETWEEN: f64 = 18.0;

/// A box and where its texts stand in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Its size.
    pub extent: Extent,
    texts: Vec<Text>,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Where the ports begin.
    ports_y: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Text {
    words: String,
    class: &'static str,
    size: f64,
    /// Left end and base line, from the box's corner.
    x: f64,
    y: f64,
    /// Where it ends, for one that stands at the right side.
    ends: Option<f64>,
}

impl Drawn {
    /// As large as what is written in it.
    pub fn new(node: &Node) -> Self {
        let widest = |words: &[String]| {
            let widths = words.iter().map(|one| text_width(one, NOTE));
            widths.fold(0.0, f64::max)
        };
        let ports = widest(&node.inputs) + BETWEEN + widest(&node.outputs);
        let inner = text_width(&node.name, NAME)
            .max(widest(&node.notes))
            .max(ports);
        let width = (inner + 2.0 * PADDING).ceil();
        let mut texts = vec![Text {
            words: node.name.clone(),
            class: "name",
            size: NAME,
            x: PADDING,
            y: PADDING + NAME,
            ends: None,
        }];
        let notes_y = PADDING + NAME + 5.0;
        let row = |from: f64, index: usize| from + ROW * (index as f64 + 0.75);
        texts.extend(node.notes.iter().enumerate().map(|(index, words)| Text {
            words: words.clone(),
            class: "note",
            size: NOTE,
            x: PADDING,
            y: row(notes_y, index),
            ends: None,
        }));
        let ports_y = notes_y + ROW * node.notes.len() as f64 + 4.0;
        let port = |words: &String, index: usize, x: f64, ends: Option<f64>| Text {
            words: words.clone(),
            class: "port",
            size: NOTE,
            x,
            y: row(ports_y, index),
            ends,
        };
        let inputs = node.inputs.iter().enumerate();
        texts.extend(inputs.map(|(index, words)| port(words, index, PADDING, None)));
        let outputs = node.outputs.iter().enumerate();
        texts.extend(outputs.map(|(index, words)| {
            port(
                words,
                index,
                width - PADDING - text_width(words, NOTE),
                Some(width - PADDING),
            )
        }));
        let rows = node.inputs.len().max(node.outputs.len());
        Self {
            extent: Extent {
                width,
                height: (ports_y + ROW * rows as f64 + 4.0).ceil(),
            },
            texts,
            inputs: node.inputs.clone(),
            outputs: node.outputs.clone(),
            ports_y,
        }
    }

    /// How far below its top a line goes in: at the input, or beside the name.
    pub fn input_y(&self, port: Option<&str>) -> f64 {
        self.port_y(&self.inputs, port)
    }

    /// How far below its top a line goes out: at the output, or beside the name, as for who looks on
    /// at an input.
    pub fn output_y(&self, port: Option<&str>) -> f64 {
        self.port_y(&self.outputs, port)
    }

    fn port_y(&self, names: &[String], port: Option<&str>) -> f64 {
        let index = names.iter().position(|name| Some(name.as_str()) == port);
        match index {
            Some(index) => self.ports_y + ROW * (index as f64 + 0.5),
            None => PADDING + NAME / 2.0,
        }
    }

    /// The box at its place.
    pub fn at(&self, area: &Area, class: &str) -> String {
        let mut svg = format!(
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" \
             rx=\"4\"/>\n",
            area.x, area.y, area.width, area.height
        );
        for text in &self.texts {
            let (x, anchor) = match text.ends {
                Some(ends) => (ends, " text-anchor=\"end\""),
                None => (text.x, ""),
            };
            let (x, y) = (area.x + x, area.y + text.y);
            // Writing to memory does not fail.
            let _infallible = writeln!(
                svg,
                "<text class=\"{}\" x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{}\"{anchor}>{}</text>",
                text.class,
                text.size,
                escaped(&text.words)
            );
        }
        svg
    }
}

/// How wide a text is at most, in the widest of the usual fonts; letters of East Asian scripts are as
/// wide as high.
pub fn text_width(text: &str, size: f64) -> f64 {
    let letters = text.chars().map(|letter| match letter {
        '\u{1100}'.. => 1.05,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 1.0,
        'A'..='Z' => 0.8,
        'i' | 'j' | 'l' | '.' | ',' | ' ' | '\'' => 0.42,
        _ => 0.68,
    });
    letters.sum::<f64>() * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::graph::diagram::NodeKind;

    #[test]
    fn every_text_stands_inside_of_its_box() {
        let words = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect();
        for (name, notes, inputs, outputs) in [
            ("a", &[][..], &[][..], &[][..]),
            (
                "camera",
                &["periodic 100 ms, priority 58, guarded"],
                &[],
                &["image"],
            ),
            (
                "카메라",
                &["안전한"],
                &["왼쪽", "b"],
                &["오른쪽_긴_이름", "c", "d"],
            ),
            (
                "a_name_that_is_longer_than_all_else",
                &["x"],
                &["in"],
                &["out"],
            ),
        ] {
            let drawn = Drawn::new(&Node {
                name: name.to_owned(),
                kind: NodeKind::Component,
                notes: words(notes),
                inputs: words(inputs),
                outputs: words(outputs),
            });
            assert_eq!(
                drawn.texts.len(),
                1 + notes.len() + inputs.len() + outputs.len()
            );
            for text in &drawn.texts {
                let end = text.x + text_width(&text.words, text.size);
                assert!(text.x >= 0.0 && end <= drawn.extent.width, "{text:?}");
                assert!(text.y - text.size >= 0.0, "{text:?}");
                assert!(text.y + 3.0 <= drawn.extent.height, "{text:?}");
            }
        }
    }
}
