//! Typed access to an element: what is asked for is known, what is left over is a warning.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use system_model::profile::Located;
use system_model::specification::Place;

use crate::problem::{ProblemLog, Severity};
use crate::suggest::{self, quoted};
use crate::tree::Element;
use crate::value::Value;

/// What drawing tools keep for themselves; it has no meaning and may stand anywhere.
const PRESENTATION: [&str; 7] = [
    "layout",
    "collapsed",
    "port_layouts",
    "port_layout",
    "bend_points",
    "topics",
    "read_only",
];

/// An element that is being read.
///
/// Every method that asks for an element or attribute makes its name known; [`Node::finish`] then
/// warns of everything whose name was never asked for. [`Document`](crate::Document) has an
/// example.
#[derive(Debug)]
pub struct Node<'a> {
    element: &'a Element,
    log: &'a ProblemLog,
    elements_asked: RefCell<Vec<&'static str>>,
    attributes_asked: RefCell<Vec<&'static str>>,
    passed_over: RefCell<Vec<&'static str>>,
    attributes_passed_over: RefCell<Vec<&'static str>>,
    text_asked: Cell<bool>,
}

/// Names that may stand in an element.
struct Known<'a> {
    asked: &'a [&'static str],
    passed_over: &'a [&'static str],
}

impl<'a> Node<'a> {
    pub(crate) fn new(element: &'a Element, log: &'a ProblemLog) -> Self {
        Self {
            element,
            log,
            elements_asked: RefCell::default(),
            attributes_asked: RefCell::default(),
            passed_over: RefCell::default(),
            attributes_passed_over: RefCell::default(),
            text_asked: Cell::new(false),
        }
    }

    /// The element's name.
    pub fn name(&self) -> &'a str {
        &self.element.name
    }

    /// The element itself.
    pub fn element(&self) -> &'a Element {
        self.element
    }

    /// Where the element's name stands.
    pub fn place(&self) -> Place {
        self.log.source().place(self.element.name_span.start)
    }

    /// The element's name with its place.
    pub fn located_name(&self) -> Located<String> {
        Located {
            value: self.element.name.clone(),
            place: self.place(),
        }
    }

    /// The child of a name. Only the first one is read, as OPRoS does; further ones are warned of.
    pub fn child(&self, name: &'static str) -> Option<Node<'a>> {
        self.child_of(&[name])
    }

    /// The child that has any of several names of the same meaning, the preferred name first.
    pub fn child_of(&self, names: &[&'static str]) -> Option<Node<'a>> {
        let mut found = self.children_of(names).into_iter();
        let first = found.next()?;
        for other in found {
            self.log.warning(
                other.element.name_span.clone(),
                format!("<{}> stands in <{}> again", other.name(), self.name()),
                Some(format!("only the first one, at {}, is read", first.place())),
            );
        }
        Some(first)
    }

    /// The child of a name; an error if there is none.
    pub fn required_child(&self, name: &'static str) -> Option<Node<'a>> {
        let found = self.child(name);
        if found.is_none() {
            self.missing_child(name);
        }
        found
    }

    /// All children of a name, in document order.
    pub fn children(&self, name: &'static str) -> Vec<Node<'a>> {
        self.children_of(&[name])
    }

    /// All children that have any of several names, in document order.
    pub fn children_of(&self, names: &[&'static str]) -> Vec<Node<'a>> {
        self.elements_asked.borrow_mut().extend(names);
        let children = self.element.children.iter();
        children
            .filter(|child| names.contains(&child.name.as_str()))
            .map(|child| Node::new(child, self.log))
            .collect()
    }

    /// The text of the child of a name, if that child exists and its text is not empty.
    pub fn value(&self, name: &'static str) -> Option<Value<'a>> {
        self.value_of(&[name])
    }

    /// As [`Node::value`], for several names of the same meaning.
    pub fn value_of(&self, names: &[&'static str]) -> Option<Value<'a>> {
        let child = self.child_of(names)?;
        let value = child.text();
        child.finish();
        (!value.is_empty()).then_some(value)
    }

    /// The text of the child of a name; an error if there is no such child, or no text in it.
    pub fn required_value(&self, name: &'static str) -> Option<Value<'a>> {
        let child = self.required_child(name)?;
        let value = child.text();
        child.finish();
        if value.is_empty() {
            child_is_empty(&child);
            return None;
        }
        Some(value)
    }

    /// The value of an attribute, if it exists and is not empty; one that is empty is warned of.
    pub fn attribute(&self, name: &'static str) -> Option<Value<'a>> {
        let value = self.written_attribute(name)?;
        if value.is_empty() {
            self.warning(
                format!("{} is empty", value.owner()),
                Some("it is not read; write a value, or remove it".into()),
            );
            return None;
        }
        Some(value)
    }

    /// The value of an attribute, which may be empty.
    fn written_attribute(&self, name: &'static str) -> Option<Value<'a>> {
        self.attributes_asked.borrow_mut().push(name);
        let mut attributes = self.element.attributes.iter();
        let found = attributes.find(|attribute| attribute.name == name)?;
        Some(Value::new(
            found.value.trim(),
            found.value_span.clone(),
            self.log,
            format!("attribute {name} of <{}>", quoted(self.name())),
        ))
    }

    /// The value of an attribute; an error if it is missing or empty.
    pub fn required_attribute(&self, name: &'static str) -> Option<Value<'a>> {
        let found = self.written_attribute(name);
        let found = found.filter(|value| !value.is_empty());
        if found.is_none() {
            self.error(
                format!("<{}> has no {name}", quoted(self.name())),
                Some(format!("write <{} {name}=\"…\">", quoted(self.name()))),
            );
        }
        found
    }

    /// The element's own text, which may be empty.
    pub fn text(&self) -> Value<'a> {
        self.text_asked.set(true);
        let span = match self.element.text_span.is_empty() {
            true => self.element.name_span.clone(),
            false => self.element.text_span.clone(),
        };
        Value::new(
            &self.element.text,
            span,
            self.log,
            format!("<{}>", quoted(self.name())),
        )
    }

    /// Elements that may stand here but are read by others, or by nobody.
    pub fn pass_over(&self, names: &[&'static str]) {
        self.passed_over.borrow_mut().extend(names);
    }

    /// Attributes that may stand here but are read by nobody.
    pub fn pass_over_attributes(&self, names: &[&'static str]) {
        self.attributes_passed_over.borrow_mut().extend(names);
    }

    /// Reports an error with this element.
    pub fn error(&self, message: impl Into<String>, help: Option<String>) {
        self.log
            .error(self.element.name_span.clone(), message, help);
    }

    /// Reports a warning about this element.
    pub fn warning(&self, message: impl Into<String>, help: Option<String>) {
        self.log
            .warning(self.element.name_span.clone(), message, help);
    }

    /// Warns of every element, attribute and text that was never asked for.
    pub fn finish(&self) {
        let unknown = |name: &str, known: &Known<'_>| {
            let everywhere = PRESENTATION.contains(&name) || name.contains(':') || name == "xmlns";
            !everywhere && !known.asked.contains(&name) && !known.passed_over.contains(&name)
        };
        let known = Known {
            asked: &self.attributes_asked.borrow(),
            passed_over: &self.attributes_passed_over.borrow(),
        };
        for attribute in &self.element.attributes {
            if unknown(&attribute.name, &known) {
                let (name, span) = (&attribute.name, &attribute.name_span);
                self.leftover(format!("attribute {}", quoted(name)), name, span, &known);
            }
        }
        let known = Known {
            asked: &self.elements_asked.borrow(),
            passed_over: &self.passed_over.borrow(),
        };
        for child in &self.element.children {
            if unknown(&child.name, &known) {
                let (name, span) = (&child.name, &child.name_span);
                self.leftover(format!("element <{}>", quoted(name)), name, span, &known);
            }
        }
        if !self.text_asked.get() && !self.element.text.is_empty() {
            self.log.warning(
                self.element.text_span.clone(),
                format!("text in <{}> is not read", quoted(self.name())),
                Some("only elements stand here; is a tag missing?".into()),
            );
        }
    }

    fn leftover(&self, what: String, name: &str, span: &Range<usize>, known: &Known<'_>) {
        let message = format!("unknown {what} in <{}>", quoted(self.name()));
        let help = match self.log.has_room_for(Severity::Warning) {
            true => self.help_for(name, known),
            false => None,
        };
        self.log.warning(span.clone(), message, help);
    }

    fn help_for(&self, name: &str, known: &Known<'_>) -> Option<String> {
        let intro = format!("<{}> may hold", quoted(self.name()));
        let all = known.asked.iter().chain(known.passed_over).copied();
        match suggest::nearest(name, all) {
            Some(near) if !known.asked.contains(&near) => Some(format!("did you mean `{near}`?")),
            _ => suggest::help(name, &intro, known.asked.iter().copied())
                .or_else(|| Some("it is not read; remove it".into())),
        }
    }

    fn missing_child(&self, name: &str) {
        self.error(
            format!("<{}> has no <{name}>", quoted(self.name())),
            Some(format!(
                "write <{name}>…</{name}> in <{}>",
                quoted(self.name())
            )),
        );
    }
}

fn child_is_empty(child: &Node<'_>) {
    let name = child.name();
    child.error(
        format!("<{name}> is empty"),
        Some(format!("write a text: <{name}>…</{name}>")),
    );
}
