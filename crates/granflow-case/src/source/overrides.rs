//! The `--set` arguments: read, and laid over the document.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::fault::CaseError;

/// Splits `key.path=value` and writes it as TOML, the value in quotes where it is a bare word.
pub(super) fn split(name: &str, argument: &str) -> Result<(Vec<String>, String), CaseError> {
    let wrong = |message: &str| {
        CaseError::new(name, argument, None, "", message.to_owned())
            .help("write --set key.path=value, for instance --set title=trial or --set 'material.friction={coulomb={mu=0.3}}'")
    };
    let (key, value) = argument.split_once('=').ok_or_else(|| wrong("there is no `=`"))?;
    let (key, value) = (key.trim(), value.trim());
    let path: Vec<String> = key.split('.').map(|part| part.trim().to_owned()).collect();
    let bare = |part: &String| {
        !part.is_empty() && part.chars().all(|sign| sign.is_ascii_alphanumeric() || "_-".contains(sign))
    };
    if !path.iter().all(bare) {
        return Err(wrong(&format!("`{key}` is not a key")));
    }
    if value.is_empty() {
        return Err(wrong("there is no value after `=`"));
    }
    let written = format!("{key} = {value}");
    if DeTable::parse(&written).is_ok() {
        return Ok((path, written));
    }
    Ok((path, format!("{key} = {}", toml::Value::String(value.to_owned()))))
}

/// Lays the single value of `over` under `path` over the document.
pub(super) fn lay_over<'a>(
    document: &mut DeTable<'a>,
    over: DeTable<'a>,
    path: &[String],
) -> Result<(), String> {
    for (key, value) in over {
        let inner = &path[1..];
        if inner.is_empty() {
            document.remove(key.get_ref().as_ref());
            document.insert(key, value);
            continue;
        }
        let span = value.span();
        let DeValue::Table(rest) = value.into_inner() else { continue };
        let step = key.get_ref().to_string();
        match document.get_mut(step.as_str()).map(Spanned::get_mut) {
            Some(DeValue::Table(table)) => lay_over(table, rest, inner)?,
            Some(DeValue::Array(list)) => lay_over_list(list, rest, inner, &step)?,
            _ => {
                document.remove(step.as_str());
                document.insert(key, Spanned::new(span, DeValue::Table(rest)));
            }
        }
    }
    Ok(())
}

fn lay_over_list<'a>(
    list: &mut DeArray<'a>,
    over: DeTable<'a>,
    path: &[String],
    name: &str,
) -> Result<(), String> {
    let count = list.len();
    let item = path[0].parse().ok().and_then(|index: usize| list.get_mut(index));
    let Some(item) = item else {
        return Err(format!("`{name}` is a list with {count} entries; `{}` is none of them", path[0]));
    };
    for (_, value) in over {
        match (path.len(), item.get_mut(), value.get_ref()) {
            (1, _, _) => *item = value,
            (_, DeValue::Table(table), DeValue::Table(_)) => {
                if let DeValue::Table(rest) = value.into_inner() {
                    lay_over(table, rest, &path[1..])?;
                }
            }
            _ => return Err(format!("entry {} of `{name}` is not a table", path[0])),
        }
    }
    Ok(())
}

/// A table whose places are counted from `by` bytes further on.
pub(super) fn shift(table: DeTable, by: usize) -> DeTable {
    let moved = |span: Range<usize>| span.start + by..span.end + by;
    table
        .into_iter()
        .map(|(key, value)| {
            let span = moved(key.span());
            (Spanned::new(span, key.into_inner()), shift_value(value, by))
        })
        .collect()
}

fn shift_value(value: Spanned<DeValue>, by: usize) -> Spanned<DeValue> {
    let span = value.span().start + by..value.span().end + by;
    let inner = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(shift(table, by)),
        DeValue::Array(array) => {
            let mut moved = DeArray::new();
            array.into_iter().for_each(|item| moved.push(shift_value(item, by)));
            DeValue::Array(moved)
        }
        other => other,
    };
    Spanned::new(span, inner)
}
