//! JSON without gaps: a number that is not finite never becomes a silent `null`.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::{Formatter, PrettyFormatter};
use serde_json::{Map, Serializer, Value};

/// The value as readable JSON text.
///
/// # Errors
/// The path of the first number that is not finite.
pub fn pretty(value: &impl Serialize) -> Result<String, String> {
    let checked = serde_json::to_value(value).map_err(|e| e.to_string())?;
    if let Some(path) = first_null(&checked) {
        return Err(format!("`{path}` is not a finite number"));
    }
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, Readable(PrettyFormatter::new()));
    value.serialize(&mut serializer).map_err(|e| e.to_string())?;
    bytes.push(b'\n');
    String::from_utf8(bytes).map_err(|e| e.to_string())
}

/// Objects over several lines, lists in one: a centreline of a hundred points is not four hundred lines.
struct Readable(PrettyFormatter<'static>);

impl Formatter for Readable {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { writer.write_all(b", ") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object(writer)
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object_value(writer)
    }
}

/// A flat record as one line of JSON; numbers that are not finite are left out and listed under `not_finite`.
///
/// # Errors
/// A record that cannot be written as JSON at all.
pub fn line(record: &impl Serialize) -> Result<String, String> {
    let text = match serde_json::to_value(record).map_err(|e| e.to_string())? {
        Value::Object(fields) if fields.values().any(Value::is_null) => {
            let (bad, mut good): (Map<_, _>, Map<_, _>) = fields.into_iter().partition(|(_, v)| v.is_null());
            good.insert("not_finite".into(), bad.into_iter().map(|(key, _)| key).collect());
            serde_json::to_string(&good)
        }
        // Written from the record itself, which keeps the order of its fields.
        _ => serde_json::to_string(record),
    };
    text.map(|text| text + "\n").map_err(|e| e.to_string())
}

/// Path of the first `null`, which is what a number that is not finite becomes.
fn first_null(value: &Value) -> Option<String> {
    match value {
        Value::Null => Some(String::new()),
        Value::Array(entries) => {
            entries.iter().enumerate().find_map(|(i, v)| first_null(v).map(|rest| format!("[{i}]{rest}")))
        }
        Value::Object(fields) => fields.iter().find_map(|(key, v)| {
            first_null(v).map(|rest| {
                if rest.starts_with('[') || rest.is_empty() { format!("{key}{rest}") } else { format!("{key}.{rest}") }
            })
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Record {
        step: usize,
        values: Vec<[f64; 2]>,
        residual: f64,
    }

    #[test]
    fn undefined_numbers_are_named() {
        let record = Record { step: 1, values: vec![[0.0, 1.0], [2.0, f64::NAN]], residual: 1.0 };
        assert_eq!(pretty(&record).unwrap_err(), "`values[1][1]` is not a finite number");
        let text = pretty(&Record { step: 1, values: vec![[0.0, 1.0], [2.0, 3.0]], residual: 0.5 }).unwrap();
        assert_eq!(text, "{\n  \"step\": 1,\n  \"values\": [[0.0, 1.0], [2.0, 3.0]],\n  \"residual\": 0.5\n}\n");
    }

    #[test]
    fn a_line_leaves_undefined_numbers_out_and_says_so() {
        let record = Record { step: 1, values: vec![], residual: f64::INFINITY };
        let value: Value = serde_json::from_str(&line(&record).unwrap()).unwrap();
        assert_eq!(value, serde_json::json!({"step": 1, "values": [], "not_finite": ["residual"]}));
    }
}
