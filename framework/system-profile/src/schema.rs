//! The XML schemas of the files that this crate reads, for editors and for tools that know no
//! Steadfast. They lie in `profiles/schema` and `rules/schema`; a test ties them to the readers.

use std::path::{Component, Path, PathBuf};

use crate::document::Document;

/// One schema.
#[derive(Debug, Clone, Copy)]
pub struct Schema {
    /// What `steadfast schema` calls it.
    pub name: &'static str,
    /// Outermost elements of the files that it is for.
    pub roots: &'static [&'static str],
    path: &'static str,
}

/// The schemas by name, the one that holds all others first.
pub const SCHEMAS: [Schema; 13] = [
    schema(
        "steadfast",
        &crate::PROFILE_ROOTS,
        "profiles/schema/steadfast.xsd",
    ),
    schema(
        "component",
        &["component_profile"],
        "profiles/schema/component.xsd",
    ),
    schema(
        "application",
        &["package_profile", "application_profile"],
        "profiles/schema/application.xsd",
    ),
    schema(
        "composite",
        &["composite_component_profile"],
        "profiles/schema/composite.xsd",
    ),
    schema(
        "service-type",
        &["service_port_type_profile"],
        "profiles/schema/service-type.xsd",
    ),
    schema("data-type", &["data_type"], "profiles/schema/data-type.xsd"),
    schema(
        "system",
        &["system_config", "system_profile"],
        "profiles/schema/system.xsd",
    ),
    schema("project", &["OPRoSProject"], "profiles/schema/project.xsd"),
    schema("world", &["world_profile"], "profiles/schema/world.xsd"),
    schema(
        "process-model",
        &["process_model"],
        "profiles/schema/process-model.xsd",
    ),
    schema("task", &["task_profile"], "profiles/schema/task.xsd"),
    schema(
        "fault-rules",
        &["fault_rules"],
        "rules/schema/fault-rules.xsd",
    ),
    schema(
        "fault-injections",
        &["fault_injections"],
        "rules/schema/fault-injections.xsd",
    ),
];

const fn schema(name: &'static str, roots: &'static [&'static str], path: &'static str) -> Schema {
    Schema { name, roots, path }
}

macro_rules! files {
    ($($path:literal),* $(,)?) => {
        &[$(($path, include_str!(concat!("../../../", $path)))),*]
    };
}

/// Every file of the schemas, by its path in the repository.
const FILES: &[(&str, &str)] = files![
    "profiles/schema/application.xsd",
    "profiles/schema/assembly.xsd",
    "profiles/schema/common.xsd",
    "profiles/schema/component.xsd",
    "profiles/schema/composite.xsd",
    "profiles/schema/data-type.xsd",
    "profiles/schema/ports.xsd",
    "profiles/schema/process-model.xsd",
    "profiles/schema/project.xsd",
    "profiles/schema/robot.xsd",
    "profiles/schema/service-type.xsd",
    "profiles/schema/steadfast.xsd",
    "profiles/schema/system.xsd",
    "profiles/schema/task-attachment.xsd",
    "profiles/schema/task-robots.xsd",
    "profiles/schema/task.xsd",
    "profiles/schema/world.xsd",
    "rules/schema/actuator-elements.xsd",
    "rules/schema/conduct-elements.xsd",
    "rules/schema/data-elements.xsd",
    "rules/schema/fault-injections.xsd",
    "rules/schema/fault-rules.xsd",
    "rules/schema/handling-elements.xsd",
    "rules/schema/model-elements.xsd",
    "rules/schema/rule-elements.xsd",
    "rules/schema/voting-elements.xsd",
];

impl Schema {
    /// The schema of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SCHEMAS.iter().find(|schema| schema.name == name)
    }

    /// What it is for, as its file says.
    pub fn purpose(&self) -> String {
        let document = Document::from_bytes(self.path, text_of(Path::new(self.path)).as_bytes());
        let said = document.tree().and_then(|root| {
            let annotation = root.child("xs:annotation")?;
            annotation.child_text("xs:documentation")
        });
        let words = said.unwrap_or_default().split_whitespace();
        words.collect::<Vec<_>>().join(" ")
    }

    /// The schema as one document (XSD 1.0, UTF-8): what its file includes stands in it.
    pub fn text(&self) -> String {
        let mut included = Vec::new();
        let mut definitions = String::new();
        include(PathBuf::from(self.path), &mut included, &mut definitions);
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\">\n{definitions}</xs:schema>\n"
        )
    }
}

/// The text of a file of the schemas; empty for one that is none.
fn text_of(path: &Path) -> &'static str {
    let found = FILES.iter().find(|(name, _)| Path::new(name) == path);
    found.map_or("", |(_, text)| text)
}

/// Appends what a file defines, then what those that it includes define, each file once.
fn include(path: PathBuf, included: &mut Vec<PathBuf>, definitions: &mut String) {
    if included.contains(&path) {
        return;
    }
    let lines = text_of(&path).lines();
    let inside = lines
        .skip_while(|line| !line.starts_with("<xs:schema"))
        .skip(1)
        .take_while(|line| *line != "</xs:schema>");
    let folder = path.parent().map(Path::to_owned).unwrap_or_default();
    included.push(path);
    let mut others = Vec::new();
    for line in inside {
        match line.trim().strip_prefix("<xs:include schemaLocation=\"") {
            Some(rest) => others.extend(rest.split('"').next()),
            None => definitions.extend([line, "\n"]),
        }
    }
    for other in others {
        include(normal(&folder.join(other)), included, definitions);
    }
}

/// A relative path without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                normal.pop();
            }
            other => normal.push(other),
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_schema_is_one_document_with_its_purpose() {
        for schema in &SCHEMAS {
            let text = schema.text();
            assert!(!text.contains("xs:include"), "{}", schema.name);
            let document = Document::from_bytes(schema.path, text.as_bytes());
            let root = document.tree().expect("well-formed");
            let declared = root.children_named("xs:element");
            let mut declared: Vec<_> = declared.filter_map(|node| node.attribute("name")).collect();
            let mut expected = schema.roots.to_vec();
            declared.sort_unstable();
            expected.sort_unstable();
            assert_eq!(declared, expected, "{}", schema.name);
            assert!(!schema.purpose().is_empty(), "{}", schema.name);
        }
    }

    #[test]
    fn every_file_is_part_of_the_whole() {
        let mut included = Vec::new();
        include(
            PathBuf::from(SCHEMAS[0].path),
            &mut included,
            &mut String::new(),
        );
        included.sort();
        let all: Vec<PathBuf> = FILES.iter().map(|(path, _)| path.into()).collect();
        assert_eq!(included, all);
    }
}
