//! The text of a case, the `--set` arguments that change it, and where each key stands.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::fault::CaseError;

/// A case as text: the file and the overrides, in one numbering of bytes, and the place of every key.
#[derive(Debug, Clone, Default)]
pub struct Source {
    pieces: Vec<Piece>,
    places: BTreeMap<String, Place>,
}

/// The file, or one `--set` argument.
#[derive(Debug, Clone)]
struct Piece {
    name: String,
    text: String,
    /// Its first byte in the common numbering.
    start: usize,
    /// The key that an argument sets.
    path: Vec<String>,
}

impl Piece {
    fn parse(&self) -> Result<Spanned<DeTable<'_>>, CaseError> {
        DeTable::parse(&self.text).map_err(|error| {
            let message = format!("this is not TOML: {}", error.message().trim());
            CaseError::new(&self.name, &self.text, error.span(), "", message)
                .help("check quotes, brackets and `=`; https://toml.io shows the format on one page")
        })
    }
}

/// Where a key and its value stand.
#[derive(Debug, Clone)]
struct Place {
    key: Range<usize>,
    value: Range<usize>,
}

impl Source {
    /// Takes the text of a file and the overrides `key.path=value` to be laid over it.
    ///
    /// # Errors
    /// A [`CaseError`] where a text is not TOML, or an override names no key.
    pub(crate) fn read(name: &str, text: &str, overrides: &[String]) -> Result<Self, CaseError> {
        let mut source = Self::default();
        source.add(name.to_owned(), text.to_owned(), Vec::new());
        for argument in overrides {
            let name = format!("--set {argument}");
            let (path, written) = split(&name, argument)?;
            source.add(name, written, path);
        }
        let mut places = BTreeMap::new();
        note_table(&mut places, "", source.document()?.get_ref());
        source.places = places;
        Ok(source)
    }

    /// The document with all overrides, each key with its place in the common numbering.
    pub(crate) fn document(&self) -> Result<Spanned<DeTable<'_>>, CaseError> {
        let mut pieces = self.pieces.iter();
        let Some(file) = pieces.next() else { return Ok(Spanned::new(0..0, DeTable::new())) };
        let mut root = file.parse()?;
        for piece in pieces {
            let table = shift_table(piece.parse()?.into_inner(), piece.start);
            lay_over(root.get_mut(), table, &piece.path).map_err(|message| {
                CaseError::new(&piece.name, &piece.text, None, &piece.path.join("."), message).help(
                    "a number in the path counts the entries of a list from 0, as in release.0.thickness=1.5",
                )
            })?;
        }
        Ok(root)
    }

    fn add(&mut self, name: String, text: String, path: Vec<String>) {
        let start = self.pieces.last().map_or(0, |last| last.start + last.text.len() + 1);
        self.pieces.push(Piece { name, text, start, path });
    }

    /// Whether the case says anything under this key.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.places.contains_key(key)
    }

    /// The text as it was given: the file, then one comment line for each override.
    #[must_use]
    pub fn text(&self) -> String {
        let mut pieces = self.pieces.iter();
        let mut all = pieces.next().map(|file| file.text.clone()).unwrap_or_default();
        for piece in pieces {
            all.push_str(&format!("\n# {}", piece.name));
        }
        all
    }

    /// The case as one TOML document: the text of the file, or its tables with the overrides laid in.
    #[must_use]
    pub fn resolved(&self) -> String {
        let [file] = self.pieces.as_slice() else {
            let document = self.document().ok();
            let table = document.map(|document| resolve_table(document.into_inner())).unwrap_or_default();
            return table.to_string();
        };
        file.text.clone()
    }

    /// The word that stands under a key, if one does.
    pub(crate) fn word(&self, key: &str) -> Option<String> {
        let mut document = self.document().ok()?.into_inner();
        let (tables, last) = key.rsplit_once('.').map_or((None, key), |(tables, last)| (Some(tables), last));
        for step in tables.iter().flat_map(|tables| tables.split('.')) {
            let DeValue::Table(inner) = document.remove(step)?.into_inner() else { return None };
            document = inner;
        }
        document.get(last)?.get_ref().as_str().map(str::to_owned)
    }

    /// The folder of the case file.
    pub(crate) fn folder(&self) -> PathBuf {
        Path::new(self.name()).parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// Name of the case file.
    #[must_use]
    pub fn name(&self) -> &str {
        self.pieces.first().map_or("", |file| file.name.as_str())
    }

    /// An error at the value of `key`, or at the nearest table around it that the case writes.
    pub(crate) fn fault(&self, key: &str, message: impl Into<String>) -> CaseError {
        self.fault_in(key, None, message)
    }

    /// An error at a part of the text that `key` holds, given as bytes of the string's content.
    pub(crate) fn fault_in(
        &self,
        key: &str,
        part: Option<Range<usize>>,
        message: impl Into<String>,
    ) -> CaseError {
        let mut outer = key;
        let place = loop {
            if let Some(place) = self.places.get(outer) {
                break Some(place);
            }
            match outer.rfind(['.', '[']) {
                Some(at) => outer = &outer[..at],
                None => break None,
            }
        };
        let exact = outer == key;
        let span = place.map(|place| if exact { place.value.clone() } else { place.key.clone() });
        let span = match (span, part) {
            (Some(span), Some(part)) if exact => Some(self.part_of_string(span, part)),
            (span, _) => span,
        };
        self.at(span, key, message.into())
    }

    /// Bytes `part` of a string's content, if the content is written without escapes; else the whole string.
    fn part_of_string(&self, span: Range<usize>, part: Range<usize>) -> Range<usize> {
        let piece = self.piece(span.start);
        let Some(raw) = piece.text.get(span.start - piece.start..span.end - piece.start) else { return span };
        let quotes = raw.len() - raw.trim_start_matches(['"', '\'']).len();
        let start = span.start + quotes + part.start;
        if raw.contains('\\') || quotes == 0 || start > span.end { span } else { start..start + part.len() }
    }

    fn piece(&self, at: usize) -> &Piece {
        let index = self.pieces.partition_point(|piece| piece.start <= at).saturating_sub(1);
        &self.pieces[index]
    }

    fn at(&self, span: Option<Range<usize>>, key: &str, message: String) -> CaseError {
        let piece = self.piece(span.as_ref().map_or(0, |span| span.start));
        let local = span.map(|span| span.start - piece.start..span.end.max(span.start) - piece.start);
        CaseError::new(&piece.name, &piece.text, local, key, message)
    }

    /// The key that stands at these bytes: the innermost key or value around them.
    fn key_at(&self, span: &Range<usize>) -> &str {
        let around = |range: &Range<usize>| range.start <= span.start && span.end <= range.end;
        self.places
            .iter()
            .flat_map(|(name, place)| [(name, &place.key), (name, &place.value)])
            .filter(|(_, range)| around(range))
            .min_by_key(|(name, range)| (range.len(), std::cmp::Reverse(name.len())))
            .map_or("", |(name, _)| name.as_str())
    }

    /// Puts what serde and toml say into a user's words, with the key and the nearest right spelling.
    pub(crate) fn explain(&self, error: &toml::de::Error, missing: &[Missing]) -> CaseError {
        let message = error.message();
        let span = error.span().filter(|span| *span != (0..0));
        let key = span.as_ref().map_or("", |span| self.key_at(span));
        let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        let plain = |text: String| self.at(span.clone(), key, text);
        match quoted.as_slice() {
            [found, known @ ..] if message.starts_with("unknown field") => {
                let table = key.rsplit_once('.').map_or("the case", |(table, _)| table);
                plain(format!("unknown key `{found}` in {table}")).allowed(found, known.iter().copied())
            }
            [found, known @ ..] if message.starts_with("unknown variant") => {
                plain(format!("found `{found}`, which is not one of the choices"))
                    .allowed(found, known.iter().copied())
            }
            [field] if message.starts_with("missing field") => {
                let full = if key.is_empty() { (*field).to_owned() } else { format!("{key}.{field}") };
                let plain = format!("the key `{field}` is missing");
                match missing.iter().find(|one| one.key == full) {
                    Some(Missing { message: Some(message), cure, .. }) => {
                        self.fault(&full, *message).help(*cure)
                    }
                    Some(Missing { cure, .. }) => self.at(span.clone(), &full, plain).help(*cure),
                    None => {
                        let table = if key.is_empty() { "the case" } else { key };
                        self.at(span.clone(), &full, plain).help(format!("add {field} = ... to {table}"))
                    }
                }
            }
            _ if message.starts_with("wanted exactly 1 element") => plain(
                "exactly one choice is wanted here".into(),
            )
            .help(format!("keep one of them; with --set, replace the whole choice: --set '{key}={{...}}'")),
            _ => plain(friendly(message)),
        }
    }
}

/// What is said where a key is missing: `message`, else that it is missing, and the cure.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Missing {
    pub key: &'static str,
    pub message: Option<&'static str>,
    pub cure: &'static str,
}

/// serde's names of types in plain words.
fn friendly(message: &str) -> String {
    let message = message.replace("invalid type: ", "found ").replace("invalid value: ", "found ");
    [
        (", expected f64", ", expected a number"),
        (", expected usize", ", expected a whole number, not negative"),
        (", expected u64", ", expected a whole number, not negative"),
        (", expected a sequence", ", expected a list [ ... ]"),
        ("floating point", "the number"),
        ("found integer", "found the number"),
        ("found string", "found the text"),
        ("found map", "found a table"),
        ("found sequence", "found a list"),
    ]
    .iter()
    .fold(message, |text, (from, to)| text.replace(from, to))
}

fn note_table(places: &mut BTreeMap<String, Place>, path: &str, table: &DeTable) {
    for (key, value) in table {
        let name =
            if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
        places.insert(name.clone(), Place { key: key.span(), value: value.span() });
        note_value(places, &name, value.get_ref());
    }
}

fn note_value(places: &mut BTreeMap<String, Place>, path: &str, value: &DeValue) {
    match value {
        DeValue::Table(table) => note_table(places, path, table),
        DeValue::Array(array) => {
            for (index, item) in array.iter().enumerate() {
                let name = format!("{path}[{index}]");
                places.insert(name.clone(), Place { key: item.span(), value: item.span() });
                note_value(places, &name, item.get_ref());
            }
        }
        _ => {}
    }
}

/// Splits `key.path=value` and writes it as TOML, the value in quotes where it is a bare word.
fn split(name: &str, argument: &str) -> Result<(Vec<String>, String), CaseError> {
    let wrong = |message: &str| {
        CaseError::new(name, argument, None, "", message.to_owned())
            .help("write --set key.path=value, for instance --set scheme.courant=0.5 or --set 'material.slope=20 deg'")
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
fn lay_over<'a>(document: &mut DeTable<'a>, over: DeTable<'a>, path: &[String]) -> Result<(), String> {
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

fn shift_table(table: DeTable, by: usize) -> DeTable {
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
        DeValue::Table(table) => DeValue::Table(shift_table(table, by)),
        DeValue::Array(array) => {
            let mut moved = DeArray::new();
            array.into_iter().for_each(|item| moved.push(shift_value(item, by)));
            DeValue::Array(moved)
        }
        other => other,
    };
    Spanned::new(span, inner)
}

/// A table without the places of its keys.
fn resolve_table(table: DeTable) -> toml::Table {
    let entries = table.into_iter();
    entries.map(|(key, value)| (key.into_inner().into_owned(), resolve(value.into_inner()))).collect()
}

fn resolve(value: DeValue) -> toml::Value {
    match value {
        DeValue::Table(table) => toml::Value::Table(resolve_table(table)),
        DeValue::Array(list) => {
            toml::Value::Array(list.into_iter().map(|item| resolve(item.into_inner())).collect())
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
