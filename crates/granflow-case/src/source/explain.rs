//! What serde and toml say, in a user's words.

use super::Source;
use crate::fault::CaseError;
use std::ops::Range;

/// What is said where a key is missing: `message`, else that it is missing, and the cure.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Missing {
    pub key: &'static str,
    pub message: Option<&'static str>,
    pub cure: &'static str,
}

impl Source {
    /// The first of the tables, and of the keys outside any, that is not `known`.
    pub(crate) fn unknown(&self, known: &[String]) -> Option<CaseError> {
        let outer = |name: &&String| !name.contains(['.', '[']) && !known.contains(name);
        let (name, place) =
            self.places.iter().filter(|(name, _)| outer(name)).min_by_key(|(_, place)| place.key.start)?;
        let mut known: Vec<&str> = known.iter().map(String::as_str).collect();
        known.sort_unstable();
        known.dedup();
        let error = self.at(Some(place.key.clone()), name, format!("unknown key `{name}` in the case"));
        Some(error.allowed(name, known))
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
                self.unknown_key(span.clone(), key, found, known.iter().copied())
            }
            _ if let Some((found, known)) = unexpected(message) => {
                self.unknown_key(span.clone(), key, found, known.split(", "))
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

    /// That the table of `key` does not know it, by the name `found` there, and what it does know.
    fn unknown_key<'a>(
        &self,
        span: Option<Range<usize>>,
        key: &str,
        found: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> CaseError {
        let table = key.rsplit_once('.').map_or("the case", |(table, _)| table);
        let error = self.at(span, key, format!("unknown key `{found}` in {table}"));
        if table.starts_with("ensemble.vary.") {
            let cure = "a key of the case stands in quotes, as in vary.\"material.friction.coulomb.mu\" = { uniform = [0.2, 0.4] }";
            return error.help(cure).allowed(found, known);
        }
        error.allowed(found, known)
    }
}

/// What the table of a choice says in words of its own: the first key that it does not know, and those it does.
fn unexpected(message: &str) -> Option<(&str, &str)> {
    let (found, known) =
        message.strip_prefix("unexpected keys in table: ")?.split_once(", available keys: ")?;
    Some((found.split(", ").next()?, known))
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
