//! A document of TOML as plain values, to be written again.

use toml::de::{DeTable, DeValue};

/// A table without the places of its keys.
pub(super) fn table(table: DeTable) -> toml::Table {
    let entries = table.into_iter();
    entries.map(|(key, inner)| (key.into_inner().into_owned(), value(inner.into_inner()))).collect()
}

fn value(spanned: DeValue) -> toml::Value {
    match spanned {
        DeValue::Table(inner) => toml::Value::Table(table(inner)),
        DeValue::Array(list) => {
            toml::Value::Array(list.into_iter().map(|item| value(item.into_inner())).collect())
        }
        DeValue::String(text) => toml::Value::String(text.into_owned()),
        DeValue::Boolean(yes) => toml::Value::Boolean(yes),
        DeValue::Datetime(instant) => toml::Value::Datetime(instant),
        DeValue::Float(number) => toml::Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(whole) => toml::Value::Integer(whole),
            // larger than any count: read as a number with a point
            Err(_) => toml::Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        },
    }
}
