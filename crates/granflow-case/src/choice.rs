//! Values that a case may write in a short way (a number, a word) or as a table.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// The short way of writing a value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Plain<'a> {
    Number(f64),
    Text(&'a str),
}

/// Reads a number or a word; `expected` names what is allowed.
pub(crate) fn plain<'de, D, V, F>(from: D, expected: &str, read: F) -> Result<V, D::Error>
where
    D: Deserializer<'de>,
    F: FnOnce(Plain) -> Result<V, String>,
{
    from.deserialize_any(Either { expected, read, table: None::<fn(Never) -> V>, marker: PhantomData })
}

/// Reads a number or a word by `read`, or a table as a `T` by `table`; `expected` names what is allowed.
pub(crate) fn plain_or_table<'de, D, T, V, F, G>(
    from: D,
    expected: &str,
    read: F,
    table: G,
) -> Result<V, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
    F: FnOnce(Plain) -> Result<V, String>,
    G: FnOnce(T) -> V,
{
    from.deserialize_any(Either { expected, read, table: Some(table), marker: PhantomData })
}

/// No table is read as this.
#[derive(Deserialize)]
enum Never {}

struct Either<'a, T, F, G> {
    expected: &'a str,
    read: F,
    table: Option<G>,
    marker: PhantomData<T>,
}

impl<'de, T, V, F, G> Visitor<'de> for Either<'_, T, F, G>
where
    T: Deserialize<'de>,
    F: FnOnce(Plain) -> Result<V, String>,
    G: FnOnce(T) -> V,
{
    type Value = V;

    fn expecting(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.write_str(self.expected)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<V, E> {
        (self.read)(Plain::Number(value)).map_err(E::custom)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<V, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<V, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<V, E> {
        (self.read)(Plain::Text(value)).map_err(E::custom)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<V, A::Error> {
        let Some(table) = self.table else {
            return Err(A::Error::invalid_type(serde::de::Unexpected::Map, &self.expected));
        };
        let value = T::deserialize(MapAccessDeserializer::new(&mut map))?;
        // a choice takes the first key only: a second one must not pass unseen
        if map.next_key::<IgnoredAny>()?.is_some() {
            return Err(A::Error::custom("wanted exactly 1 element, more than 1 element"));
        }
        Ok(table(value))
    }
}
