//! The figure of the Earth, and how long a metre on the ground is on a map, for the projections whose inverse proj4rs has.

use super::projection::{ALBERS, CASSINI, HOTINE_CENTRE, HOTINE_ORIGIN, LAMBERT_AZIMUTHAL, LAMBERT_CONIC};
use super::projection::{
    AZIMUTH, EASTING, GRID_ANGLE, LATITUDE, LONGITUDE, NORTHING, PARALLEL_1, PARALLEL_2,
};
use super::projection::{OBLIQUE_STEREOGRAPHIC, POLAR, POLYCONIC, Projection, SCALE, TRANSVERSE_MERCATOR};
use proj4rs::proj::Proj;
use proj4rs::transform::transform;

/// The figure of the Earth below a map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Globe {
    /// Semi-major axis \[m\].
    pub axis: f64,
    /// 0 for a sphere.
    pub inverse_flattening: f64,
    /// Degrees of its prime meridian east of Greenwich.
    pub meridian: f64,
}

impl Globe {
    pub const WGS_84: Globe = Globe { axis: 6_378_137.0, inverse_flattening: 298.257_223_563, meridian: 0.0 };

    /// The square of the eccentricity.
    pub fn squared(&self) -> f64 {
        let f = if self.inverse_flattening > 1.0 { 1.0 / self.inverse_flattening } else { 0.0 };
        f * (2.0 - f)
    }

    /// The radius of a parallel over the semi-major axis.
    pub fn parallel(&self, latitude: f64) -> f64 {
        latitude.cos() / (1.0 - self.squared() * latitude.sin().powi(2)).sqrt()
    }

    /// atanh(e sin(phi)) / e, which on a sphere is sin(phi).
    pub fn stretched(&self, latitude: f64) -> f64 {
        let e = self.squared().sqrt();
        if e == 0.0 { latitude.sin() } else { (e * latitude.sin()).atanh() / e }
    }
}

/// Half of the distance over which the inverse is differenced \[m\]: its error of 1e-10 m counts 1e-12, the curvature of the
/// map over it less.
const STEP: f64 = 100.0;

/// The largest and the smallest of the metres on the map of a metre on the ground at a place, and its longitude from Greenwich and
/// latitude \[degrees\]; `None` of a projection that is not known here, or where the place is none of it.
///
/// With the inverse (lambda, phi) of the map, the ground below a metre along x is G_x = (N cos(phi) dlambda/dx, M dphi/dx), likewise along
/// y; N and M are the radii of curvature of parallel and meridian. The factors are the singular values of G^-1.
pub(super) fn factors(map: &Projection, globe: Globe, place: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let shape = format!("+a={} +rf={} +no_defs", globe.axis, globe.inverse_flattening);
    let shape = match globe.inverse_flattening > 1.0 {
        true => shape,
        false => format!("+R={} +no_defs", globe.axis),
    };
    let from = Proj::from_proj_string(&format!("{} {shape}", definition(map)?)).ok()?;
    let to = Proj::from_proj_string(&format!("+proj=longlat {shape}")).ok()?;
    let inverse = |x: f64, y: f64| -> Option<[f64; 2]> {
        let mut point = (x, y, 0.0);
        transform(&from, &to, &mut point).ok()?;
        Some([point.0, point.1]).filter(|found| found.iter().all(|angle| angle.is_finite()))
    };
    let [x, y] = place;
    let [longitude, latitude] = inverse(x, y)?;
    let squared = globe.squared();
    let bend = 1.0 - squared * latitude.sin().powi(2);
    let meridian = globe.axis * (1.0 - squared) / bend.powf(1.5);
    let parallel = globe.axis * globe.parallel(latitude);
    let along = |after: [f64; 2], before: [f64; 2]| -> [f64; 2] {
        let turn = std::f64::consts::TAU;
        let east = after[0] - before[0];
        let east = east - turn * (east / turn).round();
        [parallel * east / (2.0 * STEP), meridian * (after[1] - before[1]) / (2.0 * STEP)]
    };
    let [a, c] = along(inverse(x + STEP, y)?, inverse(x - STEP, y)?);
    let [b, d] = along(inverse(x, y + STEP)?, inverse(x, y - STEP)?);
    // Singular values of [[a, b], [c, d]].
    let (sum, difference) = ((a + d).hypot(c - b), (a - d).hypot(c + b));
    let (long, short) = (0.5 * (sum + difference), 0.5 * (sum - difference).abs());
    let factors = [1.0 / short, 1.0 / long];
    let degrees = [globe.meridian + longitude.to_degrees(), latitude.to_degrees()];
    factors.iter().all(|factor| factor.is_finite() && *factor > 0.0).then_some((factors, degrees))
}

/// The projection in PROJ's words, but for the figure of the Earth.
fn definition(map: &Projection) -> Option<String> {
    let value = |name| map.value(name);
    let latitude = value(LATITUDE);
    let first = map.own(PARALLEL_1).unwrap_or(latitude);
    let second = map.own(PARALLEL_2).unwrap_or(first);
    let cone = format!("+lat_1={first} +lat_2={second} +lat_0={latitude}");
    let words = match map.method.as_str() {
        TRANSVERSE_MERCATOR => format!("etmerc +lat_0={latitude}"),
        LAMBERT_CONIC => format!("lcc {cone}"),
        ALBERS => format!("aea {cone}"),
        "equidistantconic" => format!("eqdc {cone}"),
        LAMBERT_AZIMUTHAL => format!("laea +lat_0={latitude}"),
        OBLIQUE_STEREOGRAPHIC => format!("sterea +lat_0={latitude}"),
        "stereographic" => format!("stere +lat_0={latitude}"),
        POLAR if (latitude.abs() - 90.0).abs() < 1e-6 => format!("stere +lat_0={latitude}"),
        POLAR => format!("stere +lat_0={} +lat_ts={latitude}", 90f64.copysign(latitude)),
        CASSINI => format!("cass +lat_0={latitude}"),
        POLYCONIC => format!("poly +lat_0={latitude}"),
        HOTINE_ORIGIN | HOTINE_CENTRE => format!(
            "omerc +lat_0={latitude} +alpha={} +gamma={}{}",
            value(AZIMUTH),
            value(GRID_ANGLE),
            if map.method == HOTINE_ORIGIN { " +no_uoff" } else { "" }
        ),
        _ => return None,
    };
    let longitude = if words.starts_with("omerc") { "lonc" } else { "lon_0" };
    Some(format!(
        "+proj={words} +{longitude}={} +k_0={} +x_0={} +y_0={}",
        value(LONGITUDE),
        value(SCALE),
        value(EASTING),
        value(NORTHING)
    ))
}
