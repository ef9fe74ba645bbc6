//! One example run by one scheme, in memory, and what is measured on it.

use granflow::Case;
use granflow::case::Kind;
use granflow::run::Run;
use granflow::savage_hutter::exact::Riemann;

use super::examples::{EXAMPLES, Example, Id, SCHEMES};
use crate::failure::Failure;
use crate::page::parallel;

/// Slower than this is stopped, for schemes that do not reach speed 0 by construction.
const STOPPED: f64 = 1e-12;

/// The state at one instant: time in √(L/g), heights in H, velocities in √(gL).
#[derive(Debug, Clone)]
pub struct Frame {
    /// Steps done.
    pub step: u64,
    /// Time.
    pub time: f64,
    /// Heights.
    pub h: Vec<f64>,
    /// Velocities.
    pub u: Vec<f64>,
}

impl Frame {
    /// Largest |u|.
    pub fn speed(&self) -> f64 {
        self.u.iter().fold(0.0, |most, u| u.abs().max(most))
    }

    /// Sum of |h_{i+1} - h_i|.
    pub fn variation(&self) -> f64 {
        self.h.windows(2).map(|w| (w[1] - w[0]).abs()).sum()
    }

    /// Largest difference between h and its mirror image.
    pub fn asymmetry(&self) -> f64 {
        self.h.iter().zip(self.h.iter().rev()).fold(0.0, |most, (a, b)| (a - b).abs().max(most))
    }

    /// Largest |h - value|.
    pub fn off(&self, value: f64) -> f64 {
        self.h.iter().fold(0.0, |most, h| (h - value).abs().max(most))
    }

    /// Mean velocity of the mass.
    pub fn mean_velocity(&self) -> f64 {
        self.h.iter().zip(&self.u).map(|(h, u)| h * u).sum::<f64>() / self.h.iter().sum::<f64>()
    }

    /// Tops that stand more than `above` high.
    pub fn tops(&self, above: f64) -> usize {
        self.h.windows(3).filter(|w| w[1] > w[0] && w[1] >= w[2] && w[1] > above).count()
    }
}

/// A run of an example by a scheme.
#[derive(Debug)]
pub struct Computed {
    /// The example.
    pub example: &'static Example,
    /// The scheme's name in a case and in a heading.
    pub scheme: (&'static str, &'static str),
    /// Cell centres, in L.
    pub x: Vec<f64>,
    /// Cell width, in L.
    pub dx: f64,
    /// β = ε k cos ζ.
    pub beta: f64,
    /// Frames from the start on; the last is the end, or the last finite state of a run that failed.
    pub frames: Vec<Frame>,
    /// (m_end + m_out - m_start)/m_start.
    pub mass_change: f64,
    /// The same without what left.
    pub mass_growth: f64,
    /// Smallest height at any step.
    pub lowest: f64,
    /// The state at the first step with a negative height.
    pub negative: Option<Frame>,
    /// Why the run broke off.
    pub failure: Option<String>,
    /// Whether the scheme itself proves that nothing will ever move.
    pub at_rest: bool,
}

impl Computed {
    /// Runs an example by a scheme.
    pub fn run(example: &'static Example, scheme: (&'static str, &'static str)) -> Result<Self, Failure> {
        let overrides: Vec<String> = (example.overrides.iter().map(|text| (*text).to_owned()))
            .chain([format!("scheme.name={}", scheme.0)])
            .collect();
        let case = Case::parse_with(example.case, &format!("{}.toml", example.name), &overrides)?;
        let checked = case.check()?;
        let Kind::Chute(plan) = checked.kind() else { unreachable!("the examples are flows down chutes") };
        let (dx, beta) = (plan.grid.x.width(), plan.beta(0));
        let steps = checked.plan().ends.steps.unwrap_or(0);
        let mut run = checked.start()?;
        Ok(collect(example, scheme, &mut *run, Scales { steps, dx, beta }))
    }

    /// The first frame.
    pub fn start(&self) -> &Frame {
        &self.frames[0]
    }

    /// The last frame.
    pub fn end(&self) -> &Frame {
        &self.frames[self.frames.len() - 1]
    }

    /// The kept frame nearest to a step.
    pub fn at(&self, step: u64) -> &Frame {
        self.frames.iter().min_by_key(|frame| frame.step.abs_diff(step)).unwrap_or_else(|| self.start())
    }

    /// Place of the mean of the mass above a layer of height `floor`.
    pub fn centre(&self, frame: &Frame, floor: f64) -> f64 {
        let mass: f64 = frame.h.iter().map(|h| h - floor).sum();
        frame.h.iter().zip(&self.x).map(|(h, x)| (h - floor) * x).sum::<f64>() / mass
    }

    /// The exact solution at some places at the end, where the example has one.
    pub fn exact(&self, places: &[f64]) -> Option<Frame> {
        let (start, end) = (self.start(), self.end());
        let (left, right) = (start.h[0], start.h[start.h.len() - 1]);
        let flow: Box<dyn Fn(f64) -> (f64, f64)> = match self.example.id {
            Id::Constant | Id::ConstantInclined => Box::new(move |_| (left, 0.0)),
            Id::Riemann => {
                let exact = Riemann::stoker(self.beta, left, right).ok()?;
                let time = end.time;
                Box::new(move |x| (exact.flow(x, time).h, exact.flow(x, time).u))
            }
            _ => return None,
        };
        let (h, u) = places.iter().map(|&x| flow(x)).unzip();
        Some(Frame { step: end.step, time: end.time, h, u })
    }

    /// Sum of |h - exact| dx at the end.
    pub fn l1(&self) -> Option<f64> {
        let exact = self.exact(&self.x)?;
        Some(self.end().h.iter().zip(&exact.h).map(|(h, exact)| (h - exact).abs()).sum::<f64>() * self.dx)
    }

    /// Whether the mass has stopped, in words.
    pub fn stopped(&self) -> String {
        match (&self.failure, &self.negative) {
            (Some(_), Some(negative)) => {
                format!("h < 0 at step {}, last finite state at step {}", negative.step, self.end().step)
            }
            (Some(_), None) => format!("last finite state at step {}", self.end().step),
            _ if self.at_rest => "yes: proven at rest, u = 0".into(),
            _ if self.end().speed() == 0.0 => "yes: u = 0".into(),
            _ if self.end().speed() < STOPPED => format!("yes: max |u| < {STOPPED:e}"),
            _ => "no".into(),
        }
    }
}

/// All runs, by example and scheme.
#[derive(Debug)]
pub struct Runs(Vec<Computed>);

impl Runs {
    /// Runs every example by every scheme, on all cores.
    pub fn compute() -> Result<Self, Failure> {
        let schemes = SCHEMES.len();
        parallel(EXAMPLES.len() * schemes, |k| Computed::run(&EXAMPLES[k / schemes], SCHEMES[k % schemes]))
            .into_iter()
            .collect::<Result<_, _>>()
            .map(Self)
    }

    /// An example by all schemes.
    pub fn of(&self, example: Id) -> &[Computed] {
        &self.0[example as usize * SCHEMES.len()..][..SCHEMES.len()]
    }

    /// An example by Verfahren 1 to 5.
    pub fn by(&self, example: Id, verfahren: usize) -> &Computed {
        &self.of(example)[verfahren - 1]
    }

    /// The runs that broke off.
    pub fn failed(&self) -> impl Iterator<Item = &Computed> {
        self.0.iter().filter(|run| run.failure.is_some())
    }
}

/// The state of a run as it stands.
fn frame(run: &dyn Run) -> Frame {
    let field = |name| run.field(name).map_or_else(Vec::new, |view| view.iter().collect());
    Frame { step: run.steps(), time: run.time(), h: field("thickness"), u: field("velocity_x") }
}

/// What the case says of a run.
struct Scales {
    steps: u64,
    dx: f64,
    beta: f64,
}

/// Steps a run of an example for `steps` steps and keeps what is measured on it.
fn collect(
    example: &'static Example,
    scheme: (&'static str, &'static str),
    run: &mut dyn Run,
    Scales { steps, dx, beta }: Scales,
) -> Computed {
    let before = run.totals().volume;
    let lowest_of = |frame: &Frame| frame.h.iter().copied().fold(f64::INFINITY, f64::min);
    let start = frame(run);
    let (mut lowest, mut negative, mut failure) = (lowest_of(&start), None, None);
    let mut frames = vec![start.clone()];
    let (mut last, mut volume, mut out) = (start, before, 0.0);
    while run.steps() < steps {
        if let Err(error) = run.step(f64::INFINITY) {
            failure = Some(error.to_string());
            break;
        }
        last = frame(run);
        (volume, out) = (run.totals().volume, run.stepper().outflow().iter().sum());
        lowest = lowest.min(lowest_of(&last));
        if lowest < 0.0 && negative.is_none() {
            negative = Some(last.clone());
        }
        if last.step.is_multiple_of(example.every) {
            frames.push(last.clone());
        }
    }
    if frames.last().is_none_or(|frame| frame.step != last.step) {
        frames.push(last);
    }
    Computed {
        example,
        scheme,
        x: run.plane().x.clone(),
        dx,
        beta,
        frames,
        mass_change: (volume + out - before) / before,
        mass_growth: (volume - before) / before,
        lowest,
        negative,
        failure,
        at_rest: run.stepper().at_rest(),
    }
}
