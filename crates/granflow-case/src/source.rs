//! The text of a case, the `--set` arguments that change it, and where each key stands.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::CaseError;

mod explain;
mod overrides;
mod resolve;

pub(crate) use explain::Missing;

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
        source.lay(overrides)?;
        Ok(source)
    }

    /// The document with all overrides, each key with its place in the common numbering.
    pub(crate) fn document(&self) -> Result<Spanned<DeTable<'_>>, CaseError> {
        let mut pieces = self.pieces.iter();
        let Some(file) = pieces.next() else { return Ok(Spanned::new(0..0, DeTable::new())) };
        let mut root = file.parse()?;
        for piece in pieces {
            let table = overrides::shift(piece.parse()?.into_inner(), piece.start);
            overrides::lay_over(root.get_mut(), table, &piece.path).map_err(|message| {
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
            let table = document.map(|document| resolve::table(document.into_inner())).unwrap_or_default();
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

    /// The value under a key, its parts divided by dots; a number counts the entries of a list from 0, as in an override.
    pub(crate) fn value(&self, key: &str) -> Option<toml::Value> {
        let mut value = toml::Value::Table(resolve::table(self.document().ok()?.into_inner()));
        for step in key.split('.') {
            value = match value {
                toml::Value::Table(mut table) => table.remove(step)?,
                toml::Value::Array(mut list) => {
                    let index: usize = step.parse().ok()?;
                    (index < list.len()).then(|| list.swap_remove(index))?
                }
                _ => return None,
            };
        }
        Some(value)
    }

    /// The same case with more overrides laid over it.
    ///
    /// # Errors
    /// As [`Source::read`].
    pub(crate) fn with(&self, overrides: &[String]) -> Result<Self, CaseError> {
        let mut source = Self { pieces: self.pieces.clone(), places: BTreeMap::new() };
        source.lay(overrides)?;
        Ok(source)
    }

    /// Adds overrides, and notes where each key stands.
    fn lay(&mut self, overrides: &[String]) -> Result<(), CaseError> {
        for argument in overrides {
            let name = format!("--set {argument}");
            let (path, written) = overrides::split(&name, argument)?;
            self.add(name, written, path);
        }
        let mut places = BTreeMap::new();
        note_table(&mut places, "", self.document()?.get_ref());
        self.places = places;
        Ok(())
    }

    /// The text of the file alone, and the overrides `key.path=value` that are laid over it.
    pub(crate) fn parts(&self) -> (&str, Vec<String>) {
        let mut pieces = self.pieces.iter();
        let file = pieces.next().map_or("", |file| file.text.as_str());
        (file, pieces.map(|piece| piece.name.trim_start_matches("--set ").to_owned()).collect())
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
