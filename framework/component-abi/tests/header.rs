//! `component.h` says the same as this crate: a C program prints every size, offset and constant,
//! and all of them are compared.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use component_abi::{
    ABI_MAGIC, ABI_MAJOR, ABI_MINOR, Callbacks, ENTRY_SYMBOL, FieldDescriptor, Header, HostTable,
    LAYOUT_HASH, LibraryDescriptor, LogLevel, MethodDescriptor, PortDescriptor, ScalarKind, Status,
    Text, TypeDescriptor, port_direction, port_kind,
};

/// What is expected of each C expression.
#[derive(Default)]
struct Expectations(Vec<(String, u64)>);

impl Expectations {
    fn add(&mut self, expression: impl Into<String>, value: u64) {
        self.0.push((expression.into(), value));
    }

    /// A C program that prints all expressions, one a line.
    fn program(&self) -> String {
        let mut text =
            String::from("#include <component.h>\n#include <stdio.h>\nint main(void) {\n");
        for (expression, _) in &self.0 {
            writeln!(
                text,
                "    printf(\"%llu\\n\", (unsigned long long)({expression}));"
            )
            .expect("writing to memory does not fail");
        }
        text + "    return 0;\n}\n"
    }
}

/// Size and alignment of a structure and offset and size of each field. The pattern names all
/// fields, so a field that is added to the contract does not compile here until it is compared.
macro_rules! structure {
    ($expectations:ident, $rust:ident = $c:literal { $($field:ident),* $(,)? }) => {{
        #[allow(dead_code)] // only that it compiles matters
        fn names_every_field(value: &$rust) {
            let $rust { $($field: _),* } = value;
        }
        fn size_of_field<Whole, Field>(_of: fn(&Whole) -> &Field) -> usize {
            size_of::<Field>()
        }
        $expectations.add(concat!("sizeof(", $c, ")"), size_of::<$rust>() as u64);
        $expectations.add(concat!("_Alignof(", $c, ")"), align_of::<$rust>() as u64);
        $(
            $expectations.add(
                concat!("offsetof(", $c, ", ", stringify!($field), ")"),
                std::mem::offset_of!($rust, $field) as u64,
            );
            $expectations.add(
                concat!("sizeof(((", $c, " *)0)->", stringify!($field), ")"),
                size_of_field(|value: &$rust| &value.$field) as u64,
            );
        )*
    }};
}

fn structures(expectations: &mut Expectations) {
    structure!(expectations, Text = "steadfast_text" { data, length });
    structure!(expectations, Header = "steadfast_header" {
        magic, major, minor, size, layout_hash,
    });
    structure!(expectations, HostTable = "steadfast_host_table" {
        header, read, write, raise, call, property, now_ns, log, critical, report_fault, failed,
        open_device,
    });
    structure!(expectations, Callbacks = "steadfast_callbacks" {
        create, destroy_instance, on_initialize, on_start, on_stop, on_reset, on_error, on_recover,
        on_destroy, on_execute, on_updated, on_event, on_period_changed, on_call,
    });
    structure!(expectations, FieldDescriptor = "steadfast_field" {
        name, unit, offset, kind, reserved, count, nested,
    });
    structure!(expectations, TypeDescriptor = "steadfast_type" {
        name, size, alignment, layout_hash, fields, field_count,
    });
    structure!(expectations, MethodDescriptor = "steadfast_method" {
        name, blocking, reserved, request, reply,
    });
    structure!(expectations, PortDescriptor = "steadfast_port" {
        name, kind, direction, data_type, methods, method_count,
    });
    structure!(expectations, LibraryDescriptor = "steadfast_library_descriptor" {
        header, name, version, ports, port_count, callbacks,
    });
    expectations.add("sizeof(steadfast_status)", size_of::<Status>() as u64);
}

fn constants(expectations: &mut Expectations) {
    expectations.add("STEADFAST_ABI_MAGIC", ABI_MAGIC);
    expectations.add("STEADFAST_ABI_MAJOR", u64::from(ABI_MAJOR));
    expectations.add("STEADFAST_ABI_MINOR", u64::from(ABI_MINOR));
    expectations.add("STEADFAST_LAYOUT_HASH", LAYOUT_HASH);
    expectations.add("STEADFAST_PORT_DATA", u64::from(port_kind::DATA));
    expectations.add("STEADFAST_PORT_EVENT", u64::from(port_kind::EVENT));
    expectations.add("STEADFAST_PORT_SERVICE", u64::from(port_kind::SERVICE));
    expectations.add("STEADFAST_PORT_INPUT", u64::from(port_direction::INPUT));
    expectations.add("STEADFAST_PORT_OUTPUT", u64::from(port_direction::OUTPUT));
    for (name, level) in [
        ("ERROR", LogLevel::Error),
        ("WARNING", LogLevel::Warning),
        ("INFORMATION", LogLevel::Information),
        ("DEBUG", LogLevel::Debug),
    ] {
        expectations.add(format!("STEADFAST_LOG_{name}"), level as u64);
    }
    for (name, kind) in [
        ("STRUCTURE", ScalarKind::Structure),
        ("U8", ScalarKind::U8),
        ("U16", ScalarKind::U16),
        ("U32", ScalarKind::U32),
        ("U64", ScalarKind::U64),
        ("I8", ScalarKind::I8),
        ("I16", ScalarKind::I16),
        ("I32", ScalarKind::I32),
        ("I64", ScalarKind::I64),
        ("F32", ScalarKind::F32),
        ("F64", ScalarKind::F64),
    ] {
        expectations.add(format!("STEADFAST_SCALAR_{name}"), kind as u64);
    }
    // By their names in the code itself, so that a code cannot be forgotten in `Status::name`.
    for code in [
        200,
        202,
        204,
        400,
        401,
        402,
        403,
        404,
        405,
        408,
        500,
        501,
        502,
        504,
        505,
        0x1000_0000,
        0x1000_0200,
        0x2000_0000,
    ] {
        let name = Status(code).name();
        assert_ne!(name, "UNKNOWN", "code {code} has a name");
        expectations.add(format!("STEADFAST_{name}"), u64::from(code));
    }
}

#[test]
fn the_header_is_the_contract() {
    let mut expectations = Expectations::default();
    structures(&mut expectations);
    constants(&mut expectations);
    let program = expectations.program();
    let printed = compile_and_run("layout", &program);
    let values: Vec<u64> = printed
        .lines()
        .map(|line| line.parse().expect("the program prints numbers"))
        .collect();
    assert_eq!(values.len(), expectations.0.len());
    for ((expression, expected), found) in expectations.0.iter().zip(values) {
        assert_eq!(found, *expected, "{expression}");
    }
}

/// The macros of the header make the same tables as the crate's functions, and export the symbol
/// that the container looks for.
#[test]
fn the_macros_make_whole_tables() {
    let program = r#"
        #include <component.h>
        #include <stdio.h>
        struct sample { uint64_t number; double value; };
        static const steadfast_field fields[] = {
            STEADFAST_FIELD(struct sample, number, U64, ""),
            STEADFAST_FIELD(struct sample, value, F64, "m"),
        };
        static const steadfast_type type = STEADFAST_TYPE("Sample", struct sample, fields);
        static const steadfast_port ports[] = {
            STEADFAST_DATA_INPUT("raw", &type),
            STEADFAST_DATA_OUTPUT("smooth", &type),
            STEADFAST_EVENT_INPUT("reset", NULL),
            STEADFAST_EVENT_OUTPUT("settled", NULL),
        };
        static steadfast_instance *create(const steadfast_host_table *host,
                                          steadfast_host_context *context) {
            (void)host;
            return (steadfast_instance *)context;
        }
        static void destroy(steadfast_instance *instance) { (void)instance; }
        STEADFAST_COMPONENT("low-pass", "1.0", ports, .create = create, .destroy_instance = destroy)
        int main(void) {
            const steadfast_library_descriptor *d = &steadfast_component;
            steadfast_text text = steadfast_text_of("four");
            printf("%llu %u %u %llu %llu\n", (unsigned long long)d->header.magic, d->header.major,
                   d->header.minor, (unsigned long long)d->header.size,
                   (unsigned long long)d->header.layout_hash);
            printf("%.*s %.*s %zu\n", (int)d->name.length, (const char *)d->name.data,
                   (int)d->version.length, (const char *)d->version.data, d->port_count);
            for (size_t i = 0; i < d->port_count; i++)
                printf("%.*s %u %u %d\n", (int)d->ports[i].name.length,
                       (const char *)d->ports[i].name.data, d->ports[i].kind,
                       d->ports[i].direction, d->ports[i].data_type != NULL);
            printf("%.*s %zu %zu %zu\n", (int)fields[1].unit.length,
                   (const char *)fields[1].unit.data, fields[1].offset, type.field_count,
                   text.length);
            printf("%d %d\n", d->callbacks.create != NULL, d->callbacks.on_execute != NULL);
            return 0;
        }
    "#;
    let printed = compile_and_run("macros", program);
    let header = Header::new(size_of::<LibraryDescriptor>());
    let expected = format!(
        "{} {} {} {} {}\nlow-pass 1.0 4\nraw 0 0 1\nsmooth 0 1 1\nreset 1 0 0\nsettled 1 1 0\n\
         m 8 2 4\n1 0\n",
        header.magic, header.major, header.minor, header.size, header.layout_hash
    );
    assert_eq!(printed, expected);
    assert_eq!(ENTRY_SYMBOL, "steadfast_component");
}

/// Compiles a program with every warning as an error and gives what it prints.
fn compile_and_run(name: &str, program: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder for the program");
    let (source, binary) = (
        folder.path().join(format!("{name}.c")),
        folder.path().join(name),
    );
    std::fs::write(&source, program).expect("the program is written");
    let compiler = std::env::var("CC").unwrap_or_else(|_unset| "cc".to_owned());
    let compiled = Command::new(&compiler)
        .args([
            "-std=c11",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-I",
        ])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("include"))
        .arg("-o")
        .args([&binary, &source])
        .output()
        .unwrap_or_else(|error| panic!("no C compiler '{compiler}': {error}"));
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let ran = Command::new(&binary).output().expect("the program runs");
    assert!(ran.status.success());
    String::from_utf8(ran.stdout).expect("the program prints text")
}
