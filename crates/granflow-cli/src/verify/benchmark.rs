//! What a benchmark is, what a run of it finds, and how both become rows, tables and pictures.

use granflow::output::figures::{Axis, Convergence, Curve, ErrorSeries, PictureError, Profiles, Save, Style};
use granflow::output::report::{Figure, Table};
use granflow::output::tables::{Expected, Measure, Row};
use std::path::Path;

use crate::failure::Failure;
use crate::page::{Chapter, Picture};

/// How much is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// By `granflow verify`.
    Full,
    /// By the tests and with --quick: without the finest grid, with fewer random cases.
    Small,
}

/// One benchmark: a flow whose answer is known.
pub struct Benchmark {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it is called elsewhere, after the name.
    pub title: &'static str,
    /// Setup, the known answer and its source.
    pub about: &'static str,
    /// What is computed, one piece for each scheme.
    pub pieces: fn(Size) -> Vec<Piece>,
    /// Axes and caption of the picture of the curves, if there are curves.
    pub curves: Option<View>,
    /// Axes and caption of the picture of errors over cell size, if errors are taken on several grids.
    pub errors: Option<View>,
}

impl Benchmark {
    /// Name and title.
    pub fn heading(&self) -> String {
        format!("{} {}", self.name, self.title)
    }
}

/// How a picture is to be read.
pub struct View {
    pub x: Axis<'static>,
    pub y: Axis<'static>,
    pub caption: &'static str,
}

/// The work for one scheme.
pub struct Piece {
    /// The scheme.
    pub scheme: &'static str,
    /// Computes it.
    pub work: Box<dyn Fn() -> Result<Finding, Failure> + Send + Sync>,
}

impl Piece {
    /// The work of `scheme`.
    pub fn new(
        scheme: &'static str,
        work: impl Fn() -> Result<Finding, Failure> + Send + Sync + 'static,
    ) -> Self {
        Piece { scheme, work: Box::new(work) }
    }
}

/// A named curve.
#[derive(Clone, Debug, Default)]
pub struct Line {
    pub name: String,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub style: Style,
}

/// Errors on finer and finer grids.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// Cells, along x where there are two axes.
    pub cells: Vec<usize>,
    /// Their size.
    pub sizes: Vec<f64>,
    pub errors: Vec<f64>,
}

impl Errors {
    /// Observed order over all grids: the slope of the line through the logarithms.
    pub fn order(&self) -> f64 {
        ErrorSeries { name: "", sizes: &self.sizes, errors: &self.errors }.order().unwrap_or(f64::NAN)
    }

    /// Observed order between the two finest grids.
    pub fn last_order(&self) -> f64 {
        let last = self.sizes.len().saturating_sub(2);
        ErrorSeries { name: "", sizes: &self.sizes[last..], errors: &self.errors[last..] }
            .order()
            .unwrap_or(f64::NAN)
    }
}

/// What was found for one scheme.
#[derive(Default)]
pub struct Finding {
    pub scheme: &'static str,
    pub checks: Vec<Check>,
    pub errors: Option<Errors>,
    pub curves: Vec<Line>,
    /// The known answer; drawn once.
    pub exact: Option<Line>,
}

/// A number beside what it must be, and why it may be off that far.
pub struct Check {
    pub quantity: String,
    pub expected: Expected,
    pub computed: f64,
    pub measure: Measure,
    pub tolerance: f64,
    pub reason: String,
}

impl Check {
    /// An error that must not be larger than `bound`.
    pub fn error(quantity: impl Into<String>, computed: f64, bound: f64, reason: impl Into<String>) -> Self {
        Check {
            quantity: quantity.into(),
            expected: Expected::Exact(0.0),
            computed,
            measure: Measure::AtMost,
            tolerance: bound,
            reason: reason.into(),
        }
    }

    /// A number that must reach `formal` less `short`.
    pub fn at_least(
        quantity: impl Into<String>,
        computed: f64,
        [formal, short]: [f64; 2],
        reason: impl Into<String>,
    ) -> Self {
        Check {
            expected: Expected::Exact(formal),
            measure: Measure::AtLeast,
            ..Self::error(quantity, computed, short, reason)
        }
    }

    /// The row of a benchmark and scheme.
    pub fn row(&self, name: &str, scheme: &str) -> Row {
        let Check { quantity, expected, computed, measure, tolerance, reason } = self;
        Row::new(name, format!("{scheme}: {quantity}"), *expected, *computed, *measure, *tolerance)
            .because(reason)
    }
}

/// The rows of a benchmark.
pub fn rows(benchmark: &Benchmark, findings: &[Finding]) -> Vec<Row> {
    let name = benchmark.heading();
    let of = |finding: &Finding| -> Vec<Row> {
        finding.checks.iter().map(|check| check.row(&name, finding.scheme)).collect()
    };
    findings.iter().flat_map(of).collect()
}

/// The section of a benchmark; pictures go into `folder`.
pub fn chapter<'a>(benchmark: &'a Benchmark, findings: &'a [Finding], folder: &Path) -> Chapter<'a> {
    let mut pictures = Vec::new();
    let mut add = |kind: &str, view: &'static str, draw: crate::page::Draw<'a>| {
        let path = folder.join(format!("{}_{kind}.png", benchmark.name.to_lowercase()));
        let figure = Figure { name: benchmark.heading(), caption: view.into(), path };
        pictures.push(Picture { figure, draw });
    };
    if let Some(view) = &benchmark.curves {
        add("curves", view.caption, Box::new(move |path| draw_curves(benchmark, view, findings, path)));
    }
    if let Some(view) = &benchmark.errors {
        add("errors", view.caption, Box::new(move |path| draw_errors(benchmark, view, findings, path)));
    }
    Chapter {
        title: benchmark.heading(),
        text: vec![benchmark.about.into()],
        tables: table(findings).into_iter().collect(),
        pictures,
    }
}

/// Errors by scheme and grid with their orders, where errors were taken on grids.
pub fn table(findings: &[Finding]) -> Option<Table> {
    let grids = &findings.iter().find_map(|finding| finding.errors.as_ref())?.cells;
    let head = ["Scheme".to_owned()]
        .into_iter()
        .chain(grids.iter().map(|cells| format!("{cells} cells")))
        .chain(["Order over all".to_owned(), "between the last two".to_owned()]);
    let line = |finding: &Finding| {
        let errors = finding.errors.as_ref()?;
        let cells = errors.errors.iter().map(|error| format!("{error:.2e}"));
        let orders = [errors.order(), errors.last_order()].map(|order| format!("{order:.2}"));
        Some([finding.scheme.to_owned()].into_iter().chain(cells).chain(orders).collect())
    };
    Some(Table {
        title: "Error on each grid, and the observed order".into(),
        head: head.collect(),
        lines: findings.iter().filter_map(line).collect(),
    })
}

fn draw_curves(
    benchmark: &Benchmark,
    view: &View,
    findings: &[Finding],
    path: &Path,
) -> Result<(), PictureError> {
    let exact = findings.iter().find_map(|finding| finding.exact.as_ref());
    let computed = findings.iter().flat_map(|finding| &finding.curves);
    let curves: Vec<Curve> = computed
        .map(|line| (line, None))
        .chain(exact.map(|line| (line, Some([20, 20, 20]))))
        .map(|(line, colour)| Curve { name: &line.name, x: &line.x, y: &line.y, style: line.style, colour })
        .collect();
    let title = benchmark.heading();
    Profiles { title: &title, x: view.x, y: view.y, curves: &curves, ..Default::default() }.save(path)
}

fn draw_errors(
    benchmark: &Benchmark,
    view: &View,
    findings: &[Finding],
    path: &Path,
) -> Result<(), PictureError> {
    let series: Vec<ErrorSeries> = findings
        .iter()
        .filter_map(|finding| Some((finding.scheme, finding.errors.as_ref()?)))
        .map(|(name, errors)| ErrorSeries { name, sizes: &errors.sizes, errors: &errors.errors })
        .collect();
    let title = benchmark.heading();
    Convergence {
        title: &title,
        size: view.x,
        error: view.y,
        series: &series,
        orders: &[1.0, 2.0],
        ..Default::default()
    }
    .save(path)
}
