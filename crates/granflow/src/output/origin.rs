//! What a run was made of, and how it came to where it stands: it goes on with nothing else.

use super::inputs::{Input, difference};
use granflow_case::{Change, Concerns, changes};
use serde::{Deserialize, Serialize};

/// What a run was made of.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Origin {
    /// The case as one TOML document.
    pub case: String,
    /// The files that the case names, as they were when the run began.
    pub inputs: Vec<Input>,
}

/// How a run came to where it stands.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Past {
    /// The commands so far, with their dates.
    pub commands: Vec<String>,
    /// Where it went on with another case, one sentence each.
    pub events: Vec<String>,
    /// In one of them the friction changed.
    pub mixed: bool,
}

impl Origin {
    /// What changes where a run of this origin goes on with that of `now`.
    ///
    /// # Errors
    /// Why it cannot, and what helps: the state stands on what differs.
    pub fn changes(&self, now: &Origin) -> Result<Vec<Change>, String> {
        let Some(changes) = changes(&self.case, &now.case) else {
            let cure = "give the case as it was, another --out, or start again without --resume";
            return Err(format!("the checkpoint is of another case than the one given; {cure}"));
        };
        if let Some(change) = changes.iter().find(|change| change.concerns() == Concerns::State) {
            return Err(format!(
                "the checkpoint is of another case: {change}. A run goes on with another [time], [output] (but threshold, durations \
                 and precision), friction, forest and earth_pressure (but not to or from active_passive), and with nothing else \
                 changed, such as entrainment or forest_breaks_at: give the case as it was, \
                 another --out, or start again without --resume"
            ));
        }
        // A file that only the changed keys name is another one.
        let named: Vec<&str> = changes.iter().flat_map(|change| &change.texts).map(String::as_str).collect();
        let stays = |input: &&Input| !named.iter().any(|name| input.belongs_to(name));
        let kept = |inputs: &[Input]| inputs.iter().filter(stays).cloned().collect::<Vec<_>>();
        match difference(&kept(&self.inputs), &kept(&now.inputs)) {
            None => Ok(changes),
            Some(difference) => Err(format!(
                "{difference}, so the run cannot go on; put it back as it was, or start again without --resume"
            )),
        }
    }
}

impl Input {
    /// It is the file of this name, or one that is read with it.
    fn belongs_to(&self, name: &str) -> bool {
        let name = name.trim_start_matches("./");
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let beside = |rest: &str| rest.starts_with('.') && !rest.contains('/');
        self.name == name || (!stem.is_empty() && self.name.strip_prefix(stem).is_some_and(beside))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = "terrain.dem = \"dem.tif\"\nmaterial.friction.voellmy = { mu = { raster = \"mu.tif\" }, xi = 1000 }\n";

    fn origin(case: &str, inputs: &[(&str, u32)]) -> Origin {
        let input = |&(name, crc): &(&str, u32)| Input { name: name.into(), bytes: 7, crc };
        Origin { case: case.into(), inputs: inputs.iter().map(input).collect() }
    }

    #[test]
    fn another_map_of_friction_may_come_another_mountain_may_not() {
        let then = origin(CASE, &[("dem.tif", 1), ("mu.prj", 2), ("mu.tif", 3)]);
        assert_eq!(then.changes(&then), Ok(Vec::new()));
        let other = CASE.replace("mu.tif", "soft.tif");
        let now = origin(&other, &[("dem.tif", 1), ("soft.tif", 4)]);
        let changes = then.changes(&now).unwrap();
        assert_eq!(changes[0].key, "material.friction.voellmy.mu.raster");
        let now = origin(&other, &[("dem.tif", 5), ("soft.tif", 4)]);
        assert!(then.changes(&now).unwrap_err().starts_with("dem.tif is not what the run began with"));
        let now = origin(CASE, &[("dem.tif", 1), ("mu.prj", 2), ("mu.tif", 4)]);
        assert!(then.changes(&now).unwrap_err().contains("mu.tif is not what"));
        let now = origin(&CASE.replace("dem.tif", "hill.tif"), &[("hill.tif", 1)]);
        let refused = then.changes(&now).unwrap_err();
        assert!(refused.contains("terrain.dem = \"hill.tif\" instead of \"dem.tif\""), "{refused}");
    }
}
