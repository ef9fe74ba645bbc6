//! `granflow new`: commented cases to start from.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use granflow::case::nearest;

use crate::failure::{Failure, print, tell};
use crate::mountain;

/// A file beside a case: its name, and what makes its text.
type Beside = (&'static str, fn() -> String);

/// A case to start from.
#[derive(Debug)]
pub struct Template {
    /// Its name on the command line.
    pub kind: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// The commented case.
    pub text: &'static str,
    /// The files beside it.
    pub beside: &'static [Beside],
    /// What to know before its numbers are used.
    pub warning: Option<&'static str>,
}

macro_rules! template {
    ($kind:literal, $about:literal) => {
        template!($kind, $about, &[], None)
    };
    ($kind:literal, $about:literal, $beside:expr, $warning:expr) => {
        Template {
            kind: $kind,
            about: $about,
            text: include_str!(concat!("../cases/", $kind, ".toml")),
            beside: $beside,
            warning: $warning,
        }
    };
}

/// The built-in mountain and a release on it; the same with a long foot, for laws of little friction.
const MOUNTAIN: &[Beside] = &[("mountain.asc", mountain::elevation), ("release.geojson", mountain::release)];
const LONG_MOUNTAIN: &[Beside] =
    &[("long_mountain.asc", mountain::long_elevation), ("release.geojson", mountain::release)];

const UNCALIBRATED: Option<&str> = Some(
    "its parameters are printed values for other sites, not calibrated for yours: vary them over the range that the case names, and hold \
     the result against what was mapped (granflow compare)",
);

/// The commented case of an avalanche on the built-in mountain.
pub const AVALANCHE: &str = include_str!("../cases/avalanche.toml");

/// The cases to start from.
pub const TEMPLATES: &[Template] = &[
    template!(
        "silo",
        "the walls of a silo break: a heap spreads on the flat and stops (Kaland & Struckmeier)"
    ),
    template!("inclined_silo", "the same on a slope flatter than the friction angle (Kaland & Struckmeier)"),
    template!("parabola", "a parabolic heap spreads on the flat and stops (Kaland & Struckmeier)"),
    template!("riemann", "a step without friction, with its exact solution (Kaland & Struckmeier)"),
    template!("sine", "a heap on a steep slope splits in two (Kaland & Struckmeier)"),
    template!("plane", "a cap on an inclined plane in two dimensions, SI units (Hutter et al. 1993)"),
    template!("sandpile", "sand is poured on a square table, until as much falls off (Aggarwal et al. 2023)"),
    template!("sandpile_1d", "the same between two edges (Aggarwal et al. 2023)"),
    template!("sandpile_source", "the source on a part of the table only (Aggarwal et al. 2023)"),
    template!("sandpile_walls", "walls along parts of the edges (Aggarwal et al. 2023)"),
    template!("sandpile_disc", "a round table: a cone"),
    template!("sandpile_l", "an L-shaped table with a wall"),
    template!("silo_hole", "a silo empties through a hole in its floor"),
    template!("sandpile_switched", "three sources switched on and off"),
    template!("sandpile_moving", "a source that goes round"),
    template!(
        "avalanche",
        "a mountain, a release and the way to rest; writes a small mountain too",
        MOUNTAIN,
        None
    ),
    template!(
        "snow_avalanche",
        "a dense snow avalanche, Voellmy's law with the values of Buser & Frutiger (1980); a mountain too",
        LONG_MOUNTAIN,
        UNCALIBRATED
    ),
    template!(
        "debris_flow",
        "a debris flow by its hydrograph, Voellmy's law with the start values of RAMMS; a mountain too",
        LONG_MOUNTAIN,
        UNCALIBRATED
    ),
    template!(
        "rock_avalanche",
        "a rock avalanche, Voellmy's law with the values of Hungr & Evans (1996); a mountain too",
        LONG_MOUNTAIN,
        UNCALIBRATED
    ),
];

/// Prints the kinds.
pub fn list() -> Result<(), Failure> {
    print(
        &TEMPLATES
            .iter()
            .map(|template| format!("{:18} {}\n", template.kind, template.about))
            .collect::<String>(),
    )
}

/// Writes the case `kind` to `file`, with the files it needs beside it.
pub fn new(kind: &str, file: Option<PathBuf>) -> Result<(), Failure> {
    let Some(template) = TEMPLATES.iter().find(|template| template.kind == kind) else {
        let near = nearest(kind, TEMPLATES.iter().map(|template| template.kind));
        let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let kinds: Vec<&str> = TEMPLATES.iter().map(|template| template.kind).collect();
        return Err(Failure::usage(
            format!("there is no kind `{kind}`"),
            format!("{near}allowed: {}", kinds.join(", ")),
        ));
    };
    let file = file.unwrap_or_else(|| PathBuf::from(format!("{kind}.toml")));
    let mut files = vec![(file.clone(), template.text.to_owned())];
    files.extend(template.beside.iter().map(|(name, text)| (file.with_file_name(name), text())));
    // The same mountain serves any number of cases.
    files.retain(|(path, text)| *path == file || std::fs::read_to_string(path).ok().as_ref() != Some(text));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(exists(path));
    }
    for (path, text) in &files {
        write_new(path, text)?;
    }
    let written: Vec<String> = files.iter().map(|(path, _)| path.display().to_string()).collect();
    if let Some(warning) = template.warning {
        tell(&format!("warning: {warning}\n"));
    }
    print(&format!("wrote {}; run it with: granflow run {}\n", written.join(", "), file.display()))
}

fn exists(path: &Path) -> Failure {
    Failure::File(format!(
        "{} exists and is not overwritten; give another name, or one in another folder",
        path.display()
    ))
}

/// Writes a file that was not there, in whole or not at all.
fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::AlreadyExists => exists(path),
        _ => Failure::file("write", path, &error),
    };
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(|error| {
        // A part of a case would hinder the next try.
        let _ = std::fs::remove_file(path);
        failed(error)
    })
}
