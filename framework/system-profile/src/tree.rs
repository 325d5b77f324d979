//! A document as a small tree of elements, each with the bytes of the text it was read from.
//!
//! The tree is plain data. [`Node`](crate::Node) is the way to read it with problems collected.

use std::ops::Range;

/// One element.
///
/// Trees are at most [`MAX_DEPTH`](crate::parse::MAX_DEPTH) deep, so that the compiler's recursive
/// drop of the children stays small.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Element {
    /// The name as written, with its prefix if it has one.
    pub name: String,
    /// Where the start tag has the name.
    pub name_span: Range<usize>,
    /// In document order.
    pub attributes: Vec<Attribute>,
    /// In document order.
    pub children: Vec<Element>,
    /// The element's own text with references resolved, all pieces joined, blanks at the ends cut.
    pub text: String,
    /// From the first to the last character of the text; empty, behind the name, where there is
    /// none.
    pub text_span: Range<usize>,
}

/// One attribute of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attribute {
    /// The name as written.
    pub name: String,
    /// Where the name stands.
    pub name_span: Range<usize>,
    /// The value with references resolved.
    pub value: String,
    /// Where the value stands, without its quotes.
    pub value_span: Range<usize>,
}

impl Element {
    /// The first child of a name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.name == name)
    }

    /// All children of a name.
    pub fn children_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let found = self
            .attributes
            .iter()
            .find(|attribute| attribute.name == name)?;
        Some(&found.value)
    }

    /// The text of the first child of a name.
    pub fn child_text(&self, name: &str) -> Option<&str> {
        Some(&self.child(name)?.text)
    }
}
