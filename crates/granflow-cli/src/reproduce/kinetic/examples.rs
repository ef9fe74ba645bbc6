//! The examples of the papers, as cases.

/// A published example; the order is that of [`EXAMPLES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Id {
    /// A constant layer on the flat.
    Constant,
    /// A constant layer on a slope flatter than the friction angle.
    ConstantInclined,
    /// A step without friction.
    Riemann,
    /// A silo on the flat.
    Silo,
    /// A silo on a slope.
    InclinedSilo,
    /// A parabolic heap.
    Parabola,
    /// A heap on a slope steeper than the friction angle.
    Sine,
}

/// What is run for an example.
#[derive(Debug)]
pub struct Example {
    /// Which one.
    pub id: Id,
    /// Its name in file names.
    pub name: &'static str,
    /// Its name in headings.
    pub title: &'static str,
    /// The case of `cases/`.
    pub case: &'static str,
    /// What differs from it.
    pub overrides: &'static [&'static str],
    /// Steps between two frames that are kept.
    pub every: u64,
    /// What the papers say and leave open.
    pub about: &'static str,
}

macro_rules! case {
    ($name:literal) => {
        include_str!(concat!("../../../cases/", $name, ".toml"))
    };
}

/// All examples: the six of the thesis (its first has two slopes); the report has the last five.
pub const EXAMPLES: [Example; 7] = [
    Example {
        id: Id::Constant,
        name: "constant",
        title: "Constant layer, ζ = 0",
        case: case!("constant"),
        overrides: &[],
        every: 20,
        about: "Thesis 5.1: ζ = 0, δ = π/8, 2000 steps. A constant layer on a plane flatter than the friction angle \
                must stay as it is.",
    },
    Example {
        id: Id::ConstantInclined,
        name: "constant_inclined",
        title: "Constant layer, ζ = π/16",
        case: case!("constant"),
        overrides: &["material.slope=pi/16 rad"],
        every: 20,
        about: "Thesis 5.1, second choice: ζ = π/16, δ = π/8, 2000 steps.",
    },
    Example {
        id: Id::Riemann,
        name: "riemann",
        title: "Riemann problem without friction",
        case: case!("riemann"),
        overrides: &[],
        every: 50,
        about: "Report section 4, thesis 5.2: h = 1 left of x0, 0.5 right of it, ζ = δ = 0, 5000 steps; the exact \
                solution is a fan to the left and a shock to the right. Not printed: x0 and the domain; here x0 = 0 \
                and x from -5 to 5.",
    },
    Example {
        id: Id::Silo,
        name: "silo",
        title: "Breaking silo",
        case: case!("silo"),
        overrides: &[],
        every: 50,
        about: "Report section 4, thesis 5.3: h = 2.3 between the walls and 0.3 outside, ζ = 0, δ = π/10, 10 000 \
                steps. The mass must spread symmetrically and stop. Not printed: the walls and the domain; here -1, 1 \
                and x from -6 to 6.",
    },
    Example {
        id: Id::InclinedSilo,
        name: "inclined_silo",
        title: "Breaking silo on a slope",
        case: case!("inclined_silo"),
        overrides: &[],
        every: 50,
        about: "Report section 4, thesis 5.4: the silo with ζ = π/15, δ = π/5, 8000 steps. The mass must run to the \
                right (downhill). Not printed: the walls and the domain; here -1, 1 and x from -6 to 6.",
    },
    Example {
        id: Id::Parabola,
        name: "parabola",
        title: "Parabolic heap",
        case: case!("parabola"),
        overrides: &[],
        every: 50,
        about: "Report section 4, thesis 5.5: h = max(K/10, K - l (x - x0)²), K = 1, l = 4, ζ = 0, δ = π/15, 6000 \
                steps. The heap must spread symmetrically and stop. Not printed: x0 and the domain; here 0 and x from \
                -6 to 6.",
    },
    Example {
        id: Id::Sine,
        name: "sine",
        title: "Sinusoidal heap on a steep slope",
        case: case!("sine"),
        overrides: &[],
        every: 50,
        about: "Report section 4, thesis 5.6: ε = 0.3218, ζ = π/6 above δ = π/18, 4000 steps. The heap must split in \
                two and gather speed at a constant rate. Not printed: the domain; here x from -1 to 9. Verfahren 2 to \
                4 carry mass at the mean height of two cells and lose positivity here; the papers show Verfahren 5.",
    },
];

/// The schemes that every example is run with.
pub const SCHEMES: [(&str, &str); 8] = [
    ("verfahren_1", "Verfahren 1 (Scheme 1)"),
    ("verfahren_2", "Verfahren 2"),
    ("verfahren_3", "Verfahren 3"),
    ("verfahren_4", "Verfahren 4 (Scheme 2)"),
    ("verfahren_5", "Verfahren 5 (Scheme 3)"),
    ("energy_stable", "energy_stable"),
    ("balanced", "balanced"),
    ("balanced_2", "balanced_2"),
];
