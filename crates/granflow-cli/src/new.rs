//! `granflow new`: commented cases to start from.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use granflow::case::nearest;

use crate::failure::{Failure, print};
use crate::mountain;

/// A case to start from.
#[derive(Debug)]
pub struct Template {
    /// Its name on the command line.
    pub kind: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// The commented case.
    pub text: &'static str,
}

macro_rules! template {
    ($kind:literal, $about:literal) => {
        Template { kind: $kind, about: $about, text: include_str!(concat!("../cases/", $kind, ".toml")) }
    };
}

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
    template!("avalanche", "a mountain, a release and the way to rest; writes a small mountain too"),
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
    if kind == "avalanche" {
        files.push((file.with_file_name("mountain.asc"), mountain::elevation()));
        files.push((file.with_file_name("release.geojson"), mountain::release()));
    }
    // The same mountain serves any number of cases.
    files.retain(|(path, text)| *path == file || std::fs::read_to_string(path).ok().as_ref() != Some(text));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(exists(path));
    }
    for (path, text) in &files {
        write_new(path, text)?;
    }
    let written: Vec<String> = files.iter().map(|(path, _)| path.display().to_string()).collect();
    print(&format!("wrote {}; run it with: granflow run {}\n", written.join(", "), file.display()))
}

fn exists(path: &Path) -> Failure {
    Failure::File(format!(
        "{} exists and is not overwritten; give another name, or one in another folder",
        path.display()
    ))
}

fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => exists(path),
        _ => Failure::file("write", path, &error),
    })
}
