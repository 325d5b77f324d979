//! Text to tree, iteratively and within limits, as strictly as XML 1.0 asks.

use std::ops::Range;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::suggest::quoted;
use crate::syntax;
use crate::tree::{Attribute, Element};
use crate::well_formed::{self, Malformed};

/// Profiles are 7 elements deep; what is deeper than this is damaged or hostile, and a tree of
/// bounded depth can be walked and dropped without a thought for the stack.
pub const MAX_DEPTH: usize = 128;

/// The largest public profile has fewer than 200 elements; a tree of so many takes some 30 MB.
pub const MAX_ELEMENTS: usize = 100_000;

/// Elements of profiles have at most 4 attributes; looking for duplicates costs the square.
pub const MAX_ATTRIBUTES: usize = 64;

/// What could be read of a document.
#[derive(Debug)]
pub(crate) struct Parsed {
    /// The name of the outermost element, also of a document that is malformed further on.
    pub(crate) root_name: Option<String>,
    /// The tree, or the first place where the document is not well-formed.
    pub(crate) root: Result<Element, Malformed>,
    /// What a strict reader would have refused.
    pub(crate) forgiven: Vec<Malformed>,
}

/// How much is asked of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Strictness {
    /// All that XML asks.
    Strict,
    /// `&` and `<` may stand in the values of attributes, as in files of behaviour trees.
    Forgiving,
}

/// Parses a whole document.
pub(crate) fn parse(text: &str, strictness: Strictness) -> Parsed {
    let mut builder = Builder::new(text, strictness);
    let mut root = builder.run();
    if let Some(illegal) = well_formed::illegal_character(text) {
        let comes_first = match &root {
            Ok(_) => true,
            Err(other) => illegal.span.start < other.span.start,
        };
        if comes_first {
            root = Err(illegal);
        }
    }
    Parsed {
        root_name: builder.root_name,
        root,
        forgiven: builder.forgiven,
    }
}

struct Builder<'a> {
    text: &'a str,
    open: Vec<Element>,
    root: Option<Element>,
    root_name: Option<String>,
    elements: usize,
    strictness: Strictness,
    forgiven: Vec<Malformed>,
}

impl<'a> Builder<'a> {
    fn new(text: &'a str, strictness: Strictness) -> Self {
        Self {
            text,
            open: Vec::new(),
            root: None,
            root_name: None,
            elements: 0,
            strictness,
            forgiven: Vec::new(),
        }
    }

    fn run(&mut self) -> Result<Element, Malformed> {
        let mut reader = Reader::from_str(self.text);
        reader.config_mut().check_comments = true;
        loop {
            let start = position(reader.buffer_position());
            let event = match reader.read_event() {
                Ok(event) => event,
                Err(error) => {
                    let at = position(reader.error_position());
                    return Err(syntax::offence(self.text, &error, at, self.open.last()));
                }
            };
            let span = start..position(reader.buffer_position());
            match event {
                Event::Start(tag) => self.open(&tag, span)?,
                Event::Empty(tag) => {
                    self.open(&tag, span)?;
                    self.close();
                }
                Event::End(_) => self.close(),
                Event::Text(text) => {
                    well_formed::check_text(self.text, span.clone())?;
                    self.append(&text.xml10_content(), span)?;
                }
                Event::CData(text) => self.append(&text.xml10_content(), span)?,
                Event::GeneralRef(reference) => {
                    let resolved = well_formed::resolve(&reference, span.clone())?;
                    self.append(resolved.encode_utf8(&mut [0; 4]), span)?;
                }
                Event::Decl(_) if span.start > 0 => {
                    return Err(Malformed::new(
                        span,
                        "the XML declaration does not stand at the very beginning",
                        "remove what stands before <?xml, blanks and empty lines too",
                    ));
                }
                Event::Decl(declaration) => {
                    if let Err(error) = declaration.version() {
                        return Err(syntax::offence(self.text, &error, span.start, None));
                    }
                }
                Event::Eof => return self.finish(),
                Event::Comment(_) | Event::PI(_) | Event::DocType(_) => {}
            }
        }
    }

    fn open(&mut self, tag: &BytesStart<'_>, span: Range<usize>) -> Result<(), Malformed> {
        let name = tag.name().0.to_owned();
        let name_start = span.start + 1;
        let name_span = name_start..name_start + name.len();
        if !well_formed::is_name(&name) {
            return Err(Malformed::new(
                name_span,
                format!("`{}` is no name of an element", quoted(&name)),
                "a name begins with a letter; a `<` of a text is written &lt;",
            ));
        }
        if self.open.is_empty() && self.root.is_some() {
            return Err(Malformed::new(
                name_span,
                format!("a second outermost element <{}>", quoted(&name)),
                "a file holds one document: remove what follows the first one",
            ));
        }
        self.elements += 1;
        if self.open.len() >= MAX_DEPTH || self.elements > MAX_ELEMENTS {
            return Err(Malformed::new(
                name_span,
                format!("more than {MAX_DEPTH} elements in each other, or {MAX_ELEMENTS} in all"),
                "no profile is like that: is this the right file, and is it whole?",
            ));
        }
        if self.open.is_empty() {
            self.root_name = Some(name.clone());
        }
        let attributes = self.attributes(tag, name_start)?;
        let behind = name_span.end;
        self.open.push(Element {
            name,
            name_span,
            attributes,
            text_span: behind..behind,
            ..Element::default()
        });
        Ok(())
    }

    fn attributes(
        &mut self,
        tag: &BytesStart<'_>,
        tag_start: usize,
    ) -> Result<Vec<Attribute>, Malformed> {
        let mut attributes = Vec::new();
        let mut key_start = tag_start + tag.name().0.len();
        for found in tag.attributes() {
            let found = found.map_err(|error| syntax::attribute_offence(&error, tag_start))?;
            let name = found.key.0;
            let rest = &self.text[key_start..];
            let blanks = rest.len() - rest.trim_start().len();
            key_start += blanks;
            let name_span = key_start..key_start + name.len();
            if attributes.len() == MAX_ATTRIBUTES {
                return Err(Malformed::new(
                    name_span,
                    format!("an element with more than {MAX_ATTRIBUTES} attributes"),
                    "no profile is like that: is this the right file, and is it whole?",
                ));
            }
            if blanks == 0 || !well_formed::is_name(name) {
                return Err(Malformed::new(
                    name_span,
                    format!("`{}` is no attribute", quoted(name)),
                    "attributes are written name=\"value\", with a blank before each",
                ));
            }
            let quote = self.text[name_span.end..].find(['"', '\'']).unwrap_or(0);
            let value_start = name_span.end + quote + 1;
            let value_span = value_start..value_start + found.value.len();
            let value = well_formed::attribute_value(&found, value_span.clone());
            let value = match (value, self.strictness) {
                (Err(_), Strictness::Forgiving) => {
                    self.forgiven
                        .push(well_formed::forgivable(&found, value_span.start));
                    well_formed::forgiven_value(&found)
                }
                (value, _) => value?,
            };
            key_start = value_span.end + 1;
            attributes.push(Attribute {
                name: name.to_owned(),
                name_span,
                value,
                value_span,
            });
        }
        Ok(attributes)
    }

    fn append(&mut self, piece: &str, span: Range<usize>) -> Result<(), Malformed> {
        let raw = &self.text[span.clone()];
        let inner = raw.trim();
        let Some(element) = self.open.last_mut() else {
            if inner.is_empty() {
                return Ok(());
            }
            let start = span.start + raw.len() - raw.trim_start().len();
            return Err(Malformed::new(
                start..start + inner.len().min(1),
                "text outside the outermost element",
                "remove it, or make it a comment: <!-- … -->",
            ));
        };
        element.text.push_str(piece);
        if !inner.is_empty() {
            let start = span.start + raw.len() - raw.trim_start().len();
            if element.text_span.is_empty() {
                element.text_span.start = start;
            }
            element.text_span.end = start + inner.len();
        }
        Ok(())
    }

    fn close(&mut self) {
        let Some(mut element) = self.open.pop() else {
            return;
        };
        element.text = element.text.trim().to_owned();
        match self.open.last_mut() {
            Some(parent) => parent.children.push(element),
            None => self.root = Some(element),
        }
    }

    fn finish(&mut self) -> Result<Element, Malformed> {
        if let Some(unclosed) = self.open.last() {
            return Err(Malformed::new(
                unclosed.name_span.clone(),
                format!("<{}> is never closed", quoted(&unclosed.name)),
                format!(
                    "the file ends without </{}>: is it whole?",
                    quoted(&unclosed.name)
                ),
            ));
        }
        self.root.take().ok_or_else(|| {
            Malformed::new(
                0..0,
                "the file holds no element",
                "an XML file holds one outermost element, for example <component_profile>",
            )
        })
    }
}

fn position(offset: u64) -> usize {
    usize::try_from(offset).unwrap_or(usize::MAX)
}
