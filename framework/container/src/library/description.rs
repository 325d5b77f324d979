//! What a library says of itself, copied out of its descriptor and bounded.
#![allow(unsafe_code)] // follows the pointers of a foreign descriptor

use component_abi::{
    Callbacks, FieldDescriptor, LibraryDescriptor, MethodDescriptor, PortDescriptor, ScalarKind,
    Text, TypeDescriptor, port_direction, port_kind,
};
use system_model::data_type::{DataType, Field, Scalar};
use system_model::specification::{PortDirection, PortKind};

/// More ports than any component has; a larger number is a corrupt table.
const MOST_PORTS: usize = 1024;
/// Likewise for methods of a service and fields of a type.
const MOST_ENTRIES: usize = 4096;
/// Structures inside structures.
const DEEPEST_NESTING: usize = 16;
/// Largest datum: an uncompressed 4K picture with room to spare.
const LARGEST_DATUM_BYTES: usize = 64 << 20;
/// Longest name.
const LONGEST_NAME_BYTES: usize = 256;

/// A component as its library describes it.
#[derive(Clone)]
pub struct ComponentDescription {
    /// Name of the component type.
    pub name: String,
    /// Version text.
    pub version: String,
    /// Ports; a port's position is its index.
    pub ports: Vec<PortDescription>,
    /// The callbacks.
    pub callbacks: Callbacks,
}

/// One port.
#[derive(Debug, Clone, PartialEq)]
pub struct PortDescription {
    /// Name.
    pub name: String,
    /// Data, event or service.
    pub kind: PortKind,
    /// Which way it faces.
    pub direction: PortDirection,
    /// Type of its data; none for services and events without content.
    pub data_type: Option<DataType>,
    /// Methods of a service.
    pub methods: Vec<MethodDescription>,
}

/// One method of a service.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodDescription {
    /// Name.
    pub name: String,
    /// Whether the caller waits for the reply.
    pub blocking: bool,
    /// Type of the request.
    pub request: Option<DataType>,
    /// Type of the reply.
    pub reply: Option<DataType>,
}

impl std::fmt::Debug for ComponentDescription {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("ComponentDescription")
            .field("name", &self.name)
            .field("version", &self.version)
            .field("ports", &self.ports)
            .finish_non_exhaustive()
    }
}

/// Copies a descriptor out; what cannot be is said in words.
pub(super) fn describe(
    descriptor: &'static LibraryDescriptor,
) -> Result<ComponentDescription, String> {
    let callbacks = descriptor.callbacks;
    if callbacks.create.is_none() || callbacks.destroy_instance.is_none() {
        return Err("'create' and 'destroy_instance' must be there".to_owned());
    }
    let mut ports: Vec<PortDescription> = Vec::new();
    for port in entries(descriptor.ports, descriptor.port_count, MOST_PORTS, "ports")? {
        let port = describe_port(port)?;
        if ports.iter().any(|other| other.name == port.name) {
            return Err(format!("two ports are called '{}'", port.name));
        }
        ports.push(port);
    }
    Ok(ComponentDescription {
        name: name(descriptor.name)?,
        version: name(descriptor.version)?,
        ports,
        callbacks,
    })
}

fn describe_port(port: &PortDescriptor) -> Result<PortDescription, String> {
    let port_name = name(port.name)?;
    let kind = match port.kind {
        port_kind::DATA => PortKind::Data,
        port_kind::EVENT => PortKind::Event,
        port_kind::SERVICE => PortKind::Service,
        other => return Err(format!("port '{port_name}' is of unknown kind {other}")),
    };
    let direction = match port.direction {
        port_direction::INPUT => PortDirection::Input,
        port_direction::OUTPUT => PortDirection::Output,
        other => return Err(format!("port '{port_name}' has unknown direction {other}")),
    };
    let data_type = describe_type(port.data_type)?;
    if kind == PortKind::Data && data_type.is_none() {
        return Err(format!("data port '{port_name}' has no data type"));
    }
    let methods = entries(port.methods, port.method_count, MOST_ENTRIES, "methods")?
        .iter()
        .map(describe_method)
        .collect::<Result<_, _>>()?;
    Ok(PortDescription {
        name: port_name,
        kind,
        direction,
        data_type,
        methods,
    })
}

fn describe_method(method: &MethodDescriptor) -> Result<MethodDescription, String> {
    Ok(MethodDescription {
        name: name(method.name)?,
        blocking: method.blocking != 0,
        request: describe_type(method.request)?,
        reply: describe_type(method.reply)?,
    })
}

fn describe_type(descriptor: *const TypeDescriptor) -> Result<Option<DataType>, String> {
    // SAFETY: null, or a static of the library (contract of the header).
    let Some(descriptor) = (unsafe { descriptor.as_ref() }) else {
        return Ok(None);
    };
    let type_name = name(descriptor.name)?;
    if descriptor.size > LARGEST_DATUM_BYTES {
        return Err(format!(
            "type '{type_name}' has {} bytes, more than {LARGEST_DATUM_BYTES}",
            descriptor.size
        ));
    }
    let mut fields = Vec::new();
    flatten(descriptor, "", 0, 0, &mut fields)?;
    for field in &fields {
        let end = field
            .scalar
            .size()
            .checked_mul(field.count)
            .and_then(|size| size.checked_add(field.offset));
        if end.is_none_or(|end| end > descriptor.size) {
            return Err(format!(
                "field '{}' of type '{type_name}' does not fit into its {} bytes",
                field.path, descriptor.size
            ));
        }
    }
    Ok(Some(DataType {
        name: type_name,
        size: descriptor.size,
        layout_hash: descriptor.layout_hash,
        fields,
    }))
}

/// Adds the fields of a structure that starts at `start`; arrays of structures one by one.
fn flatten(
    descriptor: &TypeDescriptor,
    prefix: &str,
    start: usize,
    depth: usize,
    fields: &mut Vec<Field>,
) -> Result<(), String> {
    if depth > DEEPEST_NESTING {
        return Err(format!("type '{prefix}' is nested too deeply"));
    }
    for field in entries(
        descriptor.fields,
        descriptor.field_count,
        MOST_ENTRIES,
        "fields",
    )? {
        let path = format!("{prefix}{}", name(field.name)?);
        let offset = start
            .checked_add(field.offset)
            .ok_or_else(|| format!("field '{path}' has an impossible offset"))?;
        if let Some(scalar) = scalar(field.kind) {
            fields.push(Field {
                path,
                unit: name(field.unit)?,
                offset,
                scalar,
                count: field.count,
            });
        } else {
            flatten_structure(field, &path, offset, depth, fields)?;
        }
        if fields.len() > MOST_ENTRIES {
            return Err("a type has too many fields".to_owned());
        }
    }
    Ok(())
}

fn flatten_structure(
    field: &FieldDescriptor,
    path: &str,
    offset: usize,
    depth: usize,
    fields: &mut Vec<Field>,
) -> Result<(), String> {
    // SAFETY: null, or a static of the library (contract of the header).
    let Some(nested) = (unsafe { field.nested.as_ref() }) else {
        return Err(format!("field '{path}' is of unknown kind {}", field.kind));
    };
    if field.count > MOST_ENTRIES {
        return Err(format!("field '{path}' has {} elements", field.count));
    }
    for index in 0..field.count {
        let prefix = if field.count == 1 {
            format!("{path}.")
        } else {
            format!("{path}[{index}].")
        };
        let start = index
            .checked_mul(nested.size)
            .and_then(|distance| distance.checked_add(offset))
            .ok_or_else(|| format!("field '{path}' has an impossible size"))?;
        flatten(nested, &prefix, start, depth + 1, fields)?;
    }
    Ok(())
}

fn scalar(kind: u32) -> Option<Scalar> {
    const KINDS: [(ScalarKind, Scalar); 10] = [
        (ScalarKind::U8, Scalar::U8),
        (ScalarKind::U16, Scalar::U16),
        (ScalarKind::U32, Scalar::U32),
        (ScalarKind::U64, Scalar::U64),
        (ScalarKind::I8, Scalar::I8),
        (ScalarKind::I16, Scalar::I16),
        (ScalarKind::I32, Scalar::I32),
        (ScalarKind::I64, Scalar::I64),
        (ScalarKind::F32, Scalar::F32),
        (ScalarKind::F64, Scalar::F64),
    ];
    KINDS
        .iter()
        .find(|(number, _)| *number as u32 == kind)
        .map(|(_, scalar)| *scalar)
}

fn entries<Entry>(
    first: *const Entry,
    count: usize,
    most: usize,
    what: &str,
) -> Result<&'static [Entry], String> {
    if count == 0 {
        return Ok(&[]);
    }
    if first.is_null() || count > most {
        return Err(format!("its table of {count} {what} cannot be"));
    }
    // SAFETY: a static table of the library with `count` entries (contract of the header); the
    // library is never unloaded.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

fn name(text: Text) -> Result<String, String> {
    let bytes = entries(
        text.data,
        text.length,
        LONGEST_NAME_BYTES,
        "bytes of a name",
    )?;
    String::from_utf8(bytes.to_vec()).map_err(|_invalid| "a name is not UTF-8".to_owned())
}
