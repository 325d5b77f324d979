//! `steadfast schema`: the XML schemas, for editors.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use system_profile::{SCHEMAS, Schema};

use super::{exit_code, manual, output};

/// What `steadfast schema` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::SCHEMA)]
pub struct SchemaArguments {
    /// Which schema to print; without a name they are listed. `steadfast` holds all others
    #[arg(value_name = "NAME", value_parser = PossibleValuesParser::new(SCHEMAS.map(|it| it.name)))]
    name: Option<String>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people and editors: the list, or the schema as it is
    Text,
    /// For programs: one JSON object
    Json,
}

/// Prints the list or one schema.
pub fn run(arguments: &SchemaArguments) -> ExitCode {
    let schema = arguments.name.as_deref().and_then(Schema::named);
    let text = match (arguments.format, schema) {
        (Format::Text, None) => list(),
        (Format::Text, Some(schema)) => schema.text(),
        (Format::Json, None) => {
            let schemas: Value = SCHEMAS.iter().map(as_json).collect();
            format!("{:#}\n", json!({ "schemas": schemas }))
        }
        (Format::Json, Some(schema)) => {
            let mut object = as_json(schema);
            object["text"] = schema.text().into();
            format!("{object:#}\n")
        }
    };
    output::finish("schema", write(&text), exit_code::DONE)
}

fn write(text: &str) -> io::Result<()> {
    let mut output = io::stdout().lock();
    output.write_all(text.as_bytes())?;
    output.flush()
}

fn list() -> String {
    let width = SCHEMAS.iter().map(|schema| schema.name.len()).max();
    let width = width.unwrap_or_default();
    let lines = SCHEMAS.iter().map(|schema| {
        let purpose = schema.purpose();
        // The first sentence; the schema itself has the others.
        let purpose = purpose.split_inclusive(". ").next().unwrap_or_default();
        format!("{:width$}  {}\n", schema.name, purpose.trim_end())
    });
    lines.collect()
}

fn as_json(schema: &Schema) -> Value {
    json!({ "name": schema.name, "roots": schema.roots, "purpose": schema.purpose() })
}
