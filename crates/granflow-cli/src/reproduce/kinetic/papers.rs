//! The papers and their figures, as data.

use super::examples::Id::{self, Constant, ConstantInclined, InclinedSilo, Parabola, Riemann, Silo, Sine};

/// A paper that can be reproduced.
#[derive(Debug)]
pub struct Paper {
    /// Its name on the command line.
    pub name: &'static str,
    /// A shorter one.
    pub alias: &'static str,
    /// Authors, title, place.
    pub title: &'static str,
    /// How its figures are called in file names and captions.
    pub figure: (&'static str, &'static str),
    /// Its figures, in order.
    pub figures: &'static [Printed],
}

impl Paper {
    /// Both names.
    pub const fn names(&self) -> [&'static str; 2] {
        [self.name, self.alias]
    }
}

/// A figure of a paper.
#[derive(Debug)]
pub struct Printed {
    /// Its number.
    pub number: &'static str,
    /// The example it shows.
    pub example: Id,
    /// What its caption says, in English.
    pub caption: &'static str,
    /// The pictures that show it.
    pub drawings: &'static [Drawing],
}

/// Which field is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// h/H.
    Height,
    /// u/√(gL).
    Velocity,
}

/// A picture of an example.
#[derive(Debug, Clone, Copy)]
pub enum Drawing {
    /// Field at the end by a Verfahren, against the exact solution.
    Exact(usize, Field),
    /// Field at some steps (the last one is the end), by Verfahren 5.
    Profiles(Field, &'static [u64]),
    /// Field over space and time by Verfahren 5, from above.
    Above(Field),
    /// Field over space and time by Verfahren 5, in perspective.
    Perspective(Field),
}

use Drawing::{Above, Exact, Perspective, Profiles};
use Field::{Height, Velocity};

const fn printed(
    number: &'static str,
    example: Id,
    caption: &'static str,
    drawings: &'static [Drawing],
) -> Printed {
    Printed { number, example, caption, drawings }
}

/// All papers.
pub const PAPERS: [Paper; 2] = [
    Paper {
        name: "kaland_struckmeier_2007",
        alias: "report",
        title: "C. Kaland and J. Struckmeier, A kinetic scheme for the Savage-Hutter equations, Hamburger Beiträge \
                zur Angewandten Mathematik 2007-15",
        figure: ("report", "Report Fig."),
        figures: &[
            printed(
                "1",
                Riemann,
                "exact and computed solution of the Riemann problem, Scheme 3, 5000 steps",
                &[Exact(5, Height), Exact(5, Velocity)],
            ),
            printed(
                "2",
                Silo,
                "the silo's height at the start, after 1100 steps and at the end",
                &[Profiles(Height, &[0, 1100, 10_000])],
            ),
            printed("3", Silo, "the silo's height in time", &[Perspective(Height), Above(Height)]),
            printed(
                "4",
                InclinedSilo,
                "height in time of the silo on the slope",
                &[Perspective(Height), Above(Height)],
            ),
            printed(
                "5",
                Parabola,
                "height in time of the parabolic heap",
                &[Perspective(Height), Above(Height)],
            ),
            printed(
                "6",
                Sine,
                "the sinusoidal heap spreads and gathers speed at a constant rate",
                &[Profiles(Height, &[0, 500, 1000, 1500, 2000, 2500, 3000, 3500, 4000]), Perspective(Height)],
            ),
        ],
    },
    Paper {
        name: "kaland_2007",
        alias: "thesis",
        title: "C. Kaland, Ein kinetisches Verfahren für die Savage-Hutter-Gleichungen, Diplomarbeit, Universität \
                Hamburg (2007)",
        figure: ("thesis", "Thesis Abb."),
        figures: &[
            printed(
                "5.1",
                Constant,
                "example 1: height and velocity after 2000 steps, ζ = 0",
                &[Exact(5, Height), Exact(5, Velocity)],
            ),
            printed(
                "5.1",
                ConstantInclined,
                "example 1: height and velocity after 2000 steps, ζ = π/16",
                &[Exact(5, Height), Exact(5, Velocity)],
            ),
            printed(
                "5.2",
                Riemann,
                "example 2: the computed solution of the Riemann problem from above",
                &[Above(Height), Above(Velocity)],
            ),
            printed(
                "5.3",
                Riemann,
                "example 2: exact solution and Verfahren 5",
                &[Exact(5, Height), Exact(5, Velocity)],
            ),
            printed(
                "5.4",
                Riemann,
                "example 2: exact solution and Verfahren 4, which oscillates",
                &[Exact(4, Height), Exact(4, Velocity)],
            ),
            printed(
                "5.5",
                Silo,
                "example 3: height and velocity of the silo from above",
                &[Above(Height), Above(Velocity)],
            ),
            printed(
                "5.6",
                Silo,
                "example 3: height and velocity of the silo in perspective",
                &[Perspective(Height), Perspective(Velocity)],
            ),
            printed("5.7", Silo, "example 3: the final profile", &[Profiles(Height, &[10_000])]),
            printed(
                "5.8",
                InclinedSilo,
                "example 4: height and velocity from above",
                &[Above(Height), Above(Velocity)],
            ),
            printed(
                "5.9",
                InclinedSilo,
                "example 4: height and velocity in perspective",
                &[Perspective(Height), Perspective(Velocity)],
            ),
            printed(
                "5.10",
                Parabola,
                "example 5: height and velocity from above",
                &[Above(Height), Above(Velocity)],
            ),
            printed(
                "5.11",
                Parabola,
                "example 5: height and velocity in perspective",
                &[Perspective(Height), Perspective(Velocity)],
            ),
            printed(
                "5.12",
                Sine,
                "example 6: a sinusoidal profile splits and gathers speed evenly",
                &[Profiles(Height, &[0, 500, 1000, 1500, 2000, 2500, 3000, 3500, 4000]), Perspective(Height)],
            ),
        ],
    },
];
