//! `package_profile` and `composite_component_profile`: instances and the connections between them.

use system_model::profile::{
    ApplicationProfile, CompositeProfile, ConnectionEnd, CoordinationRule, ExportPort, Located,
    PortConnection, Subcomponent,
};

use super::header::{self, required_attribute, required_text};
use super::mission;
use super::{APPLICATION_RULES, COMPONENT_RULES};
use super::{network, ports};
use crate::node::Node;

/// Reads an application profile.
pub(super) fn read(root: &Node<'_>) -> ApplicationProfile {
    root.pass_over(&["reference", "execution_environment"]);
    root.pass_over(&APPLICATION_RULES);
    ApplicationProfile {
        header: header::read(root),
        subcomponents: subcomponents(root),
        connections: connections(root),
        coordination: coordination(root),
        world: world(root),
        network: network::read(root).map(Box::new),
        trees: mission::trees(root),
    }
}

/// Reads a composite profile.
pub(super) fn read_composite(root: &Node<'_>) -> CompositeProfile {
    root.pass_over(&["voting"]);
    let exports = root.required_child("export_ports");
    CompositeProfile {
        header: header::read(root),
        subcomponents: subcomponents(root),
        connections: connections(root),
        coordination: coordination(root),
        exports: exports.map(|list| export_ports(&list)).unwrap_or_default(),
    }
}

fn subcomponents(root: &Node<'_>) -> Vec<Subcomponent> {
    let Some(list) = root.required_child("subcomponents") else {
        return Vec::new();
    };
    let members = list
        .children("subcomponent")
        .iter()
        .map(subcomponent)
        .collect();
    list.finish();
    members
}

fn subcomponent(node: &Node<'_>) -> Subcomponent {
    let name = required_text(node, "name");
    if name.value.contains('/') {
        node.error(
            format!("the instance name {} contains a `/`", name.value),
            Some("`/` joins the names of composites and their members; use another sign".into()),
        );
    }
    let member = Subcomponent {
        name,
        reference: required_text(node, "reference"),
        node: header::text(node, "node_id").unwrap_or_default(),
        properties: header::properties(node),
    };
    node.pass_over(&["id", "version", "type", "port"]);
    node.pass_over(&COMPONENT_RULES);
    node.finish();
    member
}

fn connections(root: &Node<'_>) -> Vec<PortConnection> {
    let Some(list) = root.required_child("port_connections") else {
        return Vec::new();
    };
    let connections = list.children("port_connection");
    let connections = connections.iter().filter_map(connection).collect();
    list.finish();
    connections
}

fn connection(node: &Node<'_>) -> Option<PortConnection> {
    let kind = ports::kind(node, node.attribute("port_type"));
    let (source, target) = (node.required_child("source"), node.required_child("target"));
    node.pass_over(&["io_type"]);
    node.pass_over_attributes(&["io_type"]);
    node.finish();
    let (source, target) = (end(&source?), end(&target?));
    Some(PortConnection {
        kind: kind?,
        source,
        target,
    })
}

/// A component and one of its ports.
pub(super) fn end(node: &Node<'_>) -> ConnectionEnd {
    let end = ConnectionEnd {
        component: required_attribute(node, "component_name"),
        port: required_attribute(node, "port_name"),
    };
    node.finish();
    end
}

fn coordination(root: &Node<'_>) -> Vec<CoordinationRule> {
    let Some(list) = root.child("coordination") else {
        return Vec::new();
    };
    let rules = list.children("depends").into_iter().map(|node| {
        let rule = CoordinationRule {
            source: required_attribute(&node, "source"),
            target: required_attribute(&node, "target"),
        };
        node.finish();
        rule
    });
    let rules = rules.collect();
    list.finish();
    rules
}

fn world(root: &Node<'_>) -> Option<Located<String>> {
    let node = root.child("world")?;
    let reference = node.required_value("reference");
    node.finish();
    Some(reference?.located())
}

fn export_ports(list: &Node<'_>) -> Vec<ExportPort> {
    let exports = list.children("export_port");
    let exports = exports.iter().filter_map(export_port).collect();
    list.finish();
    exports
}

fn export_port(node: &Node<'_>) -> Option<ExportPort> {
    let member = ConnectionEnd {
        component: required_text(node, "component_name"),
        port: required_text(node, "port_name"),
    };
    let kind = ports::kind(node, node.value("port_type"));
    let direction = node.required_value("port_dir");
    let name = node.value("export_port_name");
    let name = name.map_or_else(|| member.port.clone(), |value| value.located());
    node.finish();
    let (kind, direction) = (kind?, direction?);
    Some(ExportPort {
        name,
        member,
        direction: Located {
            value: ports::direction(&direction, kind.value)?,
            place: direction.place(),
        },
        kind,
    })
}

#[cfg(test)]
mod tests {
    use crate::document::Document;
    use crate::readers::read_profile;

    #[test]
    fn presentation_is_silent() {
        let text = br#"<package_profile><name>a</name><topics/>
            <subcomponents><subcomponent read_only="0" layout="1,2,3,4"><node_id/><name>b</name>
                <id>1</id><version>1.0</version><type>original</type><reference>b.xml</reference>
                <port_layouts><port_layout port_name="p"/></port_layouts></subcomponent></subcomponents>
            <port_connections><port_connection port_type="data" io_type="x">
                <source component_name="b" port_name="o"/><target component_name="b" port_name="i"/>
                <bend_points/></port_connection></port_connections></package_profile>"#;
        let document = Document::from_bytes("a.xml", text);
        assert!(read_profile(&document).is_some());
        assert_eq!(document.problems().len(), 0);
    }
}
