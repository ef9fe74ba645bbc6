//! A coordinate reference system in one form, whatever defines it: datum, projection, parameters, units.

use super::ground::Globe;
use super::projection::{POLAR, Projection};
use super::register;
use super::scale::Scale;
use super::wkt::Node;

/// How two systems compare.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Comparison {
    /// Datum, projection, parameters and unit agree.
    Same,
    /// They are two systems; what differs.
    Different(String),
    /// Nothing proves either; what is not known.
    Unknown(String),
}

/// Whether coordinates are degrees, lengths on a map, or lengths at no place on Earth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Geographic,
    Projected,
    Local,
}

/// A system.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct System {
    pub name: String,
    pub kind: Kind,
    /// Metres of one unit of the coordinates of a projected or local system, where it says so.
    pub unit: Option<f64>,
    datum: Option<Datum>,
    pub projection: Option<Projection>,
    /// An axis counts southward or westward.
    turned: bool,
    /// What is said of heights.
    pub heights: Option<Heights>,
}

/// The heights of a compound system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Heights {
    /// Metres upward of one unit, negative where they are depths.
    Unit(f64),
    /// A vertical system without a unit that is known.
    Unknown,
}

/// Where a system is fixed to the Earth.
#[derive(Debug, Clone, PartialEq)]
struct Datum {
    name: String,
    /// The codes that its name or its identifier may stand for.
    codes: Vec<u32>,
    /// Semi-major axis \[m\] and inverse flattening.
    ellipsoid: [f64; 2],
    /// Degrees east of Greenwich.
    meridian: f64,
}

/// Keywords of horizontal systems: three projected ones, three local ones, five geographic ones.
pub(super) const HORIZONTAL: [&str; 11] = [
    "PROJCS",
    "PROJCRS",
    "PROJECTEDCRS",
    "LOCAL_CS",
    "ENGCRS",
    "ENGINEERINGCRS",
    "GEOGCS",
    "GEOGCRS",
    "GEOGRAPHICCRS",
    "GEODCRS",
    "GEODETICCRS",
];
const BASE: [&str; 4] = ["GEOGCS", "BASEGEOGCRS", "BASEGEODCRS", "GEOGCRS"];
const VERTICAL: [&str; 4] = ["VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"];
const UNITS: [&str; 2] = ["UNIT", "LENGTHUNIT"];

impl System {
    /// The system that a definition describes, which may be compound or bound to a transformation; `None` where there is
    /// no horizontal one.
    pub fn of(root: &Node) -> Option<System> {
        let crs = root.find(&HORIZONTAL)?;
        let kind = match HORIZONTAL.iter().position(|keyword| crs.is(keyword)) {
            Some(0..3) => Kind::Projected,
            Some(3..6) => Kind::Local,
            _ => Kind::Geographic,
        };
        let base = if kind == Kind::Geographic { Some(crs) } else { crs.child(&BASE) };
        let unit = if kind == Kind::Geographic { None } else { length(crs) };
        let degrees =
            base.and_then(|base| base.child(&["UNIT", "ANGLEUNIT"])).and_then(|unit| unit.number(1));
        let degrees = degrees.map_or(1.0, f64::to_degrees);
        let projection =
            (kind == Kind::Projected).then(|| Projection::of(crs, unit.unwrap_or(1.0), degrees)).flatten();
        Some(System {
            name: crs.text(0).unwrap_or_default().to_string(),
            kind,
            unit,
            datum: base.and_then(Datum::of),
            projection,
            turned: crs.children().any(|node| node.is("AXIS") && turned(node)),
            heights: root.find(&VERTICAL).map(Heights::of),
        })
    }

    /// The scale of the map at a place; `None` where nothing is known against it.
    pub fn scale(&self, place: [f64; 2]) -> Option<Scale> {
        let globe = self.datum.as_ref().map_or(Globe::WGS_84, |datum| {
            let [axis, inverse] = datum.ellipsoid;
            Globe { axis, inverse_flattening: inverse, meridian: datum.meridian }
        });
        // Away from a pole all axes lie on meridians, and the coordinates count as ever.
        let usual = |map: &&Projection| map.method == POLAR || !self.turned;
        Scale::of(self.projection.as_ref().filter(usual)?, globe, place)
    }

    /// Compares all but the heights.
    pub fn compare(&self, other: &System) -> Comparison {
        if self.kind != other.kind {
            let of = |system: &System| match system.kind {
                Kind::Geographic => "degrees",
                Kind::Projected => "a map projection",
                Kind::Local => "local coordinates",
            };
            return Comparison::Different(format!("{} against {}", of(self), of(other)));
        }
        if let (Some(a), Some(b)) = (self.unit, other.unit)
            && (a - b).abs() > 1e-9 * a
        {
            return Comparison::Different(format!("a unit of {a} m against {b} m"));
        }
        let projections = match (&self.projection, &other.projection) {
            (Some(a), Some(b)) => a.difference(b).map_or(Comparison::Same, Comparison::Different),
            (None, None) if self.kind != Kind::Projected => Comparison::Same,
            _ => Comparison::Unknown("a projection is not given".into()),
        };
        let datums = match (&self.datum, &other.datum) {
            (Some(a), Some(b)) => a.compare(b),
            (None, None) if self.kind == Kind::Local && self.name == other.name => Comparison::Same,
            _ => Comparison::Unknown("a datum is not given".into()),
        };
        match (datums, projections) {
            (different @ Comparison::Different(_), _) | (_, different @ Comparison::Different(_)) => {
                different
            }
            (Comparison::Same, projections) => projections,
            (datums, _) => datums,
        }
    }
}

impl Datum {
    fn of(base: &Node) -> Option<Datum> {
        let datum = base.child(&["DATUM", "ENSEMBLE", "GEODETICDATUM", "TRF"])?;
        let name = datum.text(0)?.to_string();
        let codes = match datum.code() {
            Some(code) => vec![code],
            None => register::datums(&name),
        };
        let ellipsoid = datum.child(&["SPHEROID", "ELLIPSOID"])?;
        let meridian = base.child(&["PRIMEM", "PRIMEMERIDIAN"]);
        let degrees = |node: &Node| {
            let unit = node.child(&["ANGLEUNIT", "UNIT"]).and_then(|unit| unit.number(1));
            Some(node.number(1)? * unit.map_or(1.0, f64::to_degrees))
        };
        let axis =
            ellipsoid.number(1)? * ellipsoid.child(&UNITS).and_then(|unit| unit.number(1)).unwrap_or(1.0);
        Some(Datum {
            name,
            codes,
            ellipsoid: [axis, ellipsoid.number(2)?],
            meridian: meridian.and_then(degrees).unwrap_or(0.0),
        })
    }

    fn compare(&self, other: &Datum) -> Comparison {
        if (self.meridian - other.meridian).abs() > 1e-6 {
            let text = format!("prime meridian {} against {} degrees", self.meridian, other.meridian);
            return Comparison::Different(text);
        }
        let names = format!("datum {} against {}", self.name, other.name);
        let unknown = [self, other].iter().any(|datum| datum.name.to_lowercase().starts_with("unknown"));
        let one_name = !unknown && register::plain(&self.name) == register::plain(&other.name);
        if one_name || self.codes.iter().any(|code| other.codes.contains(code)) {
            return Comparison::Same;
        }
        let apart = |k: usize, small: f64| (self.ellipsoid[k] - other.ellipsoid[k]).abs() > small;
        if !self.codes.is_empty() && !other.codes.is_empty() || apart(0, 0.5) || apart(1, 1e-4) {
            return Comparison::Different(names);
        }
        Comparison::Unknown(names)
    }
}

impl Heights {
    fn of(vertical: &Node) -> Heights {
        let down =
            |axis: &Node| (1..3).filter_map(|k| axis.text(k)).any(|way| way.eq_ignore_ascii_case("down"));
        let direction = |node: &Node| {
            node.is("PARAMETER")
                && node.text(0).is_some_and(|n| n == "Direction")
                && node.number(1) == Some(-1.0)
        };
        let depths = vertical.children().any(|node| node.is("AXIS") && down(node) || direction(node));
        let sign = if depths { -1.0 } else { 1.0 };
        let unit = length(vertical).map(|unit| sign * unit).or_else(|| register::heights(vertical.code()?));
        unit.map_or(Heights::Unknown, Heights::Unit)
    }

    /// The heights of a vertical system by its code.
    pub fn coded(code: u32) -> Heights {
        register::heights(code).map_or(Heights::Unknown, Heights::Unit)
    }
}

/// Whether an axis counts southward or westward.
fn turned(axis: &Node) -> bool {
    let way = |way: &str| ["south", "west"].iter().any(|turned| way.eq_ignore_ascii_case(turned));
    (1..3).filter_map(|k| axis.text(k)).any(way)
}

/// Metres of the unit of a system, from the system itself or from its first axis.
fn length(crs: &Node) -> Option<f64> {
    let own = crs.child(&UNITS).or_else(|| crs.child(&["AXIS"])?.child(&UNITS));
    own?.number(1)
}
