//! Files of behaviour trees: what BehaviorTree.CPP 3 and 4, Nav2 and Groot write.

use behavior_tree::definition::{
    Direction, Format, Include, NodeAttribute, NodeClass, NodeDefinition, NodeModel, PortModel,
    TreeDefinition, TreeFile,
};
use system_model::profile::Located;

use crate::document::Document;
use crate::suggest::{self, quoted};
use crate::tree::{Attribute, Element};

/// The outermost element.
const TREE_ROOT: &str = "root";

/// What may stand in it.
const PARTS: [&str; 3] = ["BehaviorTree", "TreeNodesModel", "include"];

/// A tree without an ID.
const NAMELESS: &str = "BehaviorTree";

/// Makes a file of trees typed; its problems go to the document.
pub(crate) fn read(document: &Document) -> Option<TreeFile> {
    let root = document.root(&[TREE_ROOT])?.element();
    let reader = Reader {
        document,
        format: Format::V4,
    };
    let mut reader = Reader {
        format: reader.format_of(root),
        ..reader
    };
    let mut file = TreeFile {
        format: reader.format,
        main_tree: reader.value(root, "main_tree_to_execute"),
        includes: Vec::new(),
        trees: Vec::new(),
        models: Vec::new(),
    };
    reader.know(
        root,
        &["BTCPP_format", "main_tree_to_execute", "project_name"],
    );
    for part in &root.children {
        match part.name.as_str() {
            "BehaviorTree" => file.trees.extend(reader.tree(part)),
            "TreeNodesModel" => reader.models(part, &mut file.models),
            "include" => file.includes.extend(reader.include(part)),
            _ => reader.error(
                part,
                format!("unknown element <{}> in <{TREE_ROOT}>", quoted(&part.name)),
                suggest::help(&part.name, "<root> may hold", PARTS),
            ),
        }
    }
    reader.no_text(root);
    Some(file)
}

struct Reader<'a> {
    document: &'a Document,
    format: Format,
}

impl Reader<'_> {
    fn format_of(&self, root: &Element) -> Format {
        match root.attribute("BTCPP_format").map(str::trim) {
            Some("4") => Format::V4,
            None | Some("3") => Format::V3,
            Some(other) => {
                let message = format!("the format {} of trees is not known", quoted(other));
                let help =
                    "write BTCPP_format=\"4\"; without it the file is read as one of version 3";
                self.error(root, message, Some(help.into()));
                Format::V4
            }
        }
    }

    fn include(&self, element: &Element) -> Option<Include> {
        self.know(element, &["path", "ros_pkg"]);
        self.no_text(element);
        Some(Include {
            path: self.required(element, "path")?,
            ros_package: self.value(element, "ros_pkg"),
        })
    }

    fn tree(&mut self, element: &Element) -> Option<TreeDefinition> {
        self.know(element, &["ID", "_description", "_fullpath"]);
        self.no_text(element);
        let id = self.value(element, "ID").unwrap_or_else(|| Located {
            value: NAMELESS.to_owned(),
            place: self.place(element),
        });
        let root = match element.children.as_slice() {
            [root] => self.node(root),
            [] => {
                let help = "a tree has one node in it, which may have others";
                self.error(
                    element,
                    format!("the tree {} is empty", quoted(&id.value)),
                    Some(help.into()),
                );
                None
            }
            [_, second, ..] => {
                let message = format!("a second node in the tree {}", quoted(&id.value));
                let help = "a tree has one node in it: put both into a Sequence, for instance";
                self.error(second, message, Some(help.into()));
                None
            }
        };
        Some(TreeDefinition { id, root })
    }

    /// A node and all below it; documents are of bounded depth.
    fn node(&self, element: &Element) -> Option<NodeDefinition> {
        self.no_text(element);
        let is_plus = self.format == Format::V3 && element.name == "SubTreePlus";
        let class = match is_plus {
            true => Some(NodeClass::SubTree),
            false => NodeClass::named(&element.name),
        };
        let id = match class {
            Some(_) => self.required(element, "ID")?,
            None => Located {
                value: element.name.clone(),
                place: self.place(element),
            },
        };
        if class.is_none() && element.attribute("ID").is_some() {
            let help = "write <Action ID=\"…\"/> and its like, or leave the ID out";
            let message = format!("<{}> has an ID, but is one", quoted(&element.name));
            self.error(element, message, Some(help.into()));
        }
        // The value of an attribute of such a sub-tree is a key, with or without braces.
        let is_old_sub_tree =
            self.format == Format::V3 && class == Some(NodeClass::SubTree) && !is_plus;
        let attributes = element.attributes.iter();
        let attributes = attributes.filter(|it| !matches!(it.name.as_str(), "ID" | "name"));
        let attributes = attributes.map(|it| self.attribute(it, is_old_sub_tree));
        Some(NodeDefinition {
            class,
            id,
            name: self.value(element, "name"),
            attributes: attributes.collect(),
            children: element
                .children
                .iter()
                .filter_map(|it| self.node(it))
                .collect(),
        })
    }

    fn attribute(&self, attribute: &Attribute, is_key: bool) -> NodeAttribute {
        let mut name = attribute.name.clone();
        let mut value = attribute.value.clone();
        // Both were called differently in version 3.
        if self.format == Format::V3
            && matches!(name.as_str(), "__autoremap" | "__shared_blackboard")
        {
            name = "_autoremap".to_owned();
        } else if is_key && !name.starts_with('_') && !value.contains('{') {
            value = format!("{{{}}}", value.trim());
        }
        let place = |start| self.document.place(start);
        NodeAttribute {
            name: Located {
                value: name,
                place: place(attribute.name_span.start),
            },
            value: Located {
                value,
                place: place(attribute.value_span.start),
            },
        }
    }

    fn models(&self, element: &Element, models: &mut Vec<NodeModel>) {
        self.know(element, &[]);
        self.no_text(element);
        for model in &element.children {
            let Some(class) = NodeClass::named(&model.name) else {
                let names = NodeClass::ALL.map(|(name, _)| name);
                self.error(
                    model,
                    format!(
                        "unknown element <{}> in <TreeNodesModel>",
                        quoted(&model.name)
                    ),
                    suggest::help(&model.name, "it may hold", names),
                );
                continue;
            };
            let Some(id) = self.required(model, "ID") else {
                continue;
            };
            let ports = model.children.iter().filter_map(|port| self.port(port));
            models.push(NodeModel {
                id,
                class,
                ports: ports.collect(),
            });
        }
    }

    fn port(&self, element: &Element) -> Option<PortModel> {
        let direction = match element.name.as_str() {
            "input_port" => Direction::Input,
            "output_port" => Direction::Output,
            // Nav2 writes the latter.
            "inout_port" | "bidirectional_port" => Direction::Both,
            // Groot's: what the node is for, and what else an editor wants to know of it.
            "description" | "MetadataFields" => return None,
            other => {
                let names = ["input_port", "output_port", "inout_port"];
                self.error(
                    element,
                    format!("unknown element <{}> in a model", quoted(other)),
                    suggest::help(other, "it may hold", names),
                );
                return None;
            }
        };
        Some(PortModel {
            name: self.required(element, "name")?,
            direction,
            default: element.attribute("default").map(str::to_owned),
        })
    }

    fn value(&self, element: &Element, name: &str) -> Option<Located<String>> {
        let mut attributes = element.attributes.iter();
        let found = attributes.find(|attribute| attribute.name == name)?;
        let value = found.value.trim();
        (!value.is_empty()).then(|| Located {
            value: value.to_owned(),
            place: self.document.place(found.value_span.start),
        })
    }

    fn required(&self, element: &Element, name: &str) -> Option<Located<String>> {
        let found = self.value(element, name);
        if found.is_none() {
            let element_name = quoted(&element.name);
            let message = format!("<{element_name}> has no {name}");
            let help = format!("write <{element_name} {name}=\"…\">");
            self.error(element, message, Some(help));
        }
        found
    }

    /// Warns of attributes that have no meaning here.
    fn know(&self, element: &Element, names: &[&str]) {
        for attribute in &element.attributes {
            let name = attribute.name.as_str();
            if !names.contains(&name) && !name.starts_with("xmlns") {
                self.document.log().warning(
                    attribute.name_span.clone(),
                    format!(
                        "unknown attribute {} in <{}>",
                        quoted(name),
                        quoted(&element.name)
                    ),
                    suggest::help(name, "it may have", names.iter().copied())
                        .or_else(|| Some("it is not read; remove it".into())),
                );
            }
        }
    }

    fn no_text(&self, element: &Element) {
        if !element.text.is_empty() {
            self.document.log().warning(
                element.text_span.clone(),
                format!("text in <{}> is not read", quoted(&element.name)),
                Some("only elements stand here; is a tag missing?".into()),
            );
        }
    }

    fn place(&self, element: &Element) -> system_model::specification::Place {
        self.document.place(element.name_span.start)
    }

    fn error(&self, element: &Element, message: String, help: Option<String>) {
        let span = element.name_span.clone();
        self.document.log().error(span, message, help);
    }
}
