//! The kinds of cases: a model with what it is computed on. Each has a folder, declared here, and a line in `kinds!`.

use std::fmt::Debug;
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::ensemble;
use super::fault::CaseError;
use super::file_kind::FileKind;
use super::look::Look;
use super::plan::RunPlan;
use super::source::{Missing, Source};

pub mod avalanche;
pub mod chute;
pub mod sandpile;
pub mod terrain;

/// Makes [`Kind`] and the list of kinds; the model of the first is the one of a case that names none.
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident: $folder:ident),+ $(,)?) => {
        /// The numbers of a checked case that only its kind has.
        #[derive(Debug)]
        #[allow(clippy::large_enum_variant, reason = "a run has one")]
        pub enum Kind {
            $($(#[$doc])* $kind($folder::Plan),)+
        }

        const KINDS: &[Listed] = &[$(Listed::of::<$folder::Words>()),+];
    };
}

kinds! {
    /// An avalanche on a chute: savage_hutter on `[grid]`.
    Chute: chute,
    /// An avalanche on a mountain: savage_hutter on `[terrain]`.
    Terrain: terrain,
    /// A growing sandpile: hadeler_kuttler on `[grid]`.
    Sandpile: sandpile,
}

/// The words of a case, of any kind.
pub(crate) trait Words: Debug + Send + Sync {
    /// Checks and evaluates the case.
    fn check(&self, look: &Look) -> Result<(RunPlan, Kind), CaseError>;
    /// The words as TOML.
    fn to_toml(&self) -> String;
    /// Many runs of the case, if it asks for them, and whether they have a pressure.
    fn ensemble(&self) -> Option<(&ensemble::Words, bool)>;
}

/// A kind's struct of words.
pub(crate) trait Written:
    Debug + Send + Sync + Serialize + DeserializeOwned + JsonSchema + 'static
{
    /// What is known of the kind before its keys are read.
    const ABOUT: About;
    /// Checks and evaluates the case.
    fn check(&self, look: &Look) -> Result<(RunPlan, Kind), CaseError>;
    /// Many runs of the case, if it asks for them, and whether they have a pressure.
    fn ensemble(&self) -> Option<(&ensemble::Words, bool)> {
        None
    }
}

impl<W: Written> Words for W {
    fn check(&self, look: &Look) -> Result<(RunPlan, Kind), CaseError> {
        Written::check(self, look)
    }

    fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    fn ensemble(&self) -> Option<(&ensemble::Words, bool)> {
        Written::ensemble(self)
    }
}

/// What is known of a kind before its keys are read.
pub(crate) struct About {
    /// Name of the model.
    pub model: &'static str,
    /// The table that tells kinds of one model apart.
    pub place: &'static str,
    /// Keys that not every model has.
    pub keys: &'static [&'static str],
    /// Keys of other kinds, each with an answer of its own.
    pub foreign: &'static [Foreign],
    /// Names of the schemes.
    pub schemes: &'static [&'static str],
    /// What `time.until` may be.
    pub until: &'static [&'static str],
    /// Keys that a case must have, with the answer where it has not.
    pub missing: &'static [Missing],
}

/// A key that a kind does not have: `message`, else that it has no meaning for the model, and the cure.
pub(crate) struct Foreign {
    pub key: &'static str,
    pub message: Option<&'static str>,
    pub cure: &'static str,
}

/// Two lists of keys as one.
const fn joined<const A: usize, const B: usize, const ALL: usize>(
    first: [&'static str; A],
    second: [&'static str; B],
) -> [&'static str; ALL] {
    assert!(A + B == ALL, "the list is as long as both");
    let mut all = [""; ALL];
    let mut number = 0;
    while number < ALL {
        all[number] = if number < A { first[number] } else { second[number - A] };
        number += 1;
    }
    all
}

/// A kind in the list.
struct Listed {
    about: About,
    read: fn(toml::de::Deserializer) -> Result<Arc<dyn Words>, toml::de::Error>,
    schema: fn(&mut SchemaGenerator) -> Schema,
    /// The names of its tables and of its keys outside any table.
    tables: fn() -> Vec<String>,
}

impl Listed {
    const fn of<W: Written>() -> Self {
        Self {
            about: W::ABOUT,
            read: |document| Ok(Arc::new(W::deserialize(document)?)),
            schema: |generator| generator.subschema_for::<W>(),
            tables: || {
                let schema = SchemaGenerator::default().into_root_schema_for::<W>();
                let tables = schema.get("properties").and_then(serde_json::Value::as_object);
                tables.into_iter().flatten().map(|(name, _)| name.clone()).collect()
            },
        }
    }
}

/// The tables by which a case is known from other files, in the order of the alphabet.
pub(crate) fn tables() -> Vec<String> {
    let mut tables: Vec<String> = KINDS.iter().flat_map(|kind| (kind.tables)()).collect();
    tables.retain(|name| !matches!(name.as_str(), "title" | "model"));
    tables.sort();
    tables.dedup();
    tables
}

/// The words of a case, of the kind that it says.
pub(crate) fn read(source: &Source) -> Result<Arc<dyn Words>, CaseError> {
    let kind = choose(source)?;
    kind.about.refuse_foreign(source)?;
    let document = toml::de::Deserializer::from(source.document()?);
    (kind.read)(document).map_err(|error| source.explain(&error, kind.about.missing))
}

/// The kind that `model` and the tables of a case ask for; where they leave it open, the first of the model.
fn choose(source: &Source) -> Result<&'static Listed, CaseError> {
    let mut models: Vec<&str> = KINDS.iter().map(|kind| kind.about.model).collect();
    models.dedup();
    let model = match source.word("model") {
        Some(word) => word,
        None if source.has("model") => {
            let fault = source.fault("model", "expected the name of a model in quotes");
            return Err(fault.help(format!("allowed: {}", models.join(", "))));
        }
        None => models[0].to_owned(),
    };
    let of_model: Vec<&Listed> = KINDS.iter().filter(|kind| kind.about.model == model).collect();
    let Some(first) = of_model.first() else {
        let message = format!("found `{model}`, which is not one of the choices");
        return Err(source.fault("model", message).allowed(&model, models));
    };
    let placed: Vec<&Listed> = of_model.iter().copied().filter(|kind| source.has(kind.about.place)).collect();
    match placed.as_slice() {
        // a misspelt place must not be answered as if the other were meant
        [] => match source.unknown(&of_model.iter().flat_map(|kind| (kind.tables)()).collect::<Vec<_>>()) {
            Some(error) => Err(error),
            None => Ok(first),
        },
        [one] => Ok(one),
        [one, other, ..] => {
            let [one, other] = [one, other].map(|kind| kind.about.place);
            let message = format!("the case has both [{one}] and [{other}]");
            Err(source.fault(other, message).help("keep one of them"))
        }
    }
}

impl About {
    /// Refuses what belongs to other kinds; it is never ignored.
    fn refuse_foreign(&self, source: &Source) -> Result<(), CaseError> {
        let model = self.model;
        if let Some(Foreign { key, message, cure }) = self.foreign.iter().find(|one| source.has(one.key)) {
            let message =
                message.map_or_else(|| format!("`{key}` has no meaning for {model}"), str::to_owned);
            return Err(source.fault(key, message).help(*cure));
        }
        let (scheme, until) = (source.word("scheme.name"), source.word("time.until"));
        for other in KINDS.iter().map(|kind| &kind.about).filter(|other| other.model != model) {
            let foreign = |key: &&&str| source.has(key) && !self.keys.contains(key);
            if let Some(key) = other.keys.iter().find(foreign) {
                // Where the model is not named, a misspelt `model` may be what is wrong.
                let every = || KINDS.iter().flat_map(|kind| (kind.tables)()).collect::<Vec<_>>();
                if let Some(error) = (!source.has("model")).then(|| source.unknown(&every())).flatten() {
                    return Err(error);
                }
                let message = format!("`{key}` belongs to the model {}", other.model);
                let cure = format!("remove it, or write model = \"{}\"", other.model);
                return Err(source.fault(key, message).help(cure));
            }
            if let Some(name) = strange(scheme.as_deref(), other.schemes, self.schemes) {
                let message = format!("the scheme {name} is not one of {model}");
                let cure = format!("allowed: {}", self.schemes.join(", "));
                return Err(source.fault("scheme.name", message).help(cure));
            }
            if let Some(word) = strange(until.as_deref(), other.until, self.until) {
                let message = format!("{model} has no end \"{word}\"");
                let own = self.until.join("\" or \"");
                return Err(source.fault("time.until", message).help(format!("write until = \"{own}\"")));
            }
        }
        Ok(())
    }
}

/// The word, if the other kind has it and this one has not.
fn strange<'a>(word: Option<&'a str>, other: &[&str], own: &[&str]) -> Option<&'a str> {
    word.filter(|word| other.contains(word) && !own.contains(word))
}

/// The JSON Schema of the case file: one of the kinds of cases, with these kinds of files.
#[must_use]
pub fn json_schema(files: &[FileKind]) -> serde_json::Value {
    let mut generator = SchemaGenerator::default();
    let kinds: Vec<Schema> = KINDS.iter().map(|kind| (kind.schema)(&mut generator)).collect();
    let dialect = generator.settings().meta_schema.clone();
    serde_json::json!({
        "$schema": dialect,
        "title": "granflow case",
        "anyOf": kinds,
        "$defs": with_files(generator.take_definitions(true), files),
    })
}

/// The definitions with the names that `output.files` may hold.
fn with_files(
    mut definitions: serde_json::Map<String, serde_json::Value>,
    files: &[FileKind],
) -> serde_json::Map<String, serde_json::Value> {
    let name = |kind: &FileKind| serde_json::json!({ "const": kind.name, "description": kind.about });
    let names: Vec<serde_json::Value> = files.iter().map(name).collect();
    if let Some(items) =
        definitions.get_mut("Output").and_then(|output| output.pointer_mut("/properties/files/items"))
    {
        *items = serde_json::json!({ "oneOf": names });
    }
    definitions
}
