//! The scale of maps of the world: how long a metre on the ground is on the map, where it lies.

use super::projection::{EASTING, EQUAL_AREA, EQUIDISTANT, LATITUDE, LONGITUDE, MERCATOR, NORTHING};
use super::projection::{PARALLEL_1, PSEUDO_MERCATOR, Projection, SCALE};

/// Maps of the world, by their names without blanks and underscores, whose scale is not computed: they are true to scale on a
/// few lines at most.
const WORLD: [&str; 40] = [
    "aitoff",
    "behrmann",
    "compactmiller",
    "crasterparabolic",
    "cube",
    "eckerti",
    "eckertii",
    "eckertiii",
    "eckertiv",
    "eckertv",
    "eckertvi",
    "equalearth",
    "flatpolarquartic",
    "fuller",
    "gallorthographic",
    "gallstereographic",
    "goodehomolosine",
    "hammer",
    "hammeraitoff",
    "hobodyercylindrical",
    "interruptedgoodehomolosine",
    "loximuthal",
    "mcbrydethomasflatpolarquartic",
    "millercylindrical",
    "mollweide",
    "naturalearth",
    "naturalearthii",
    "patterson",
    "quarticauthalic",
    "robinson",
    "sinusoidal",
    "times",
    "vandergrinten",
    "vandergrinteni",
    "wagneriv",
    "wagnerv",
    "wagnervii",
    "winkeli",
    "winkelii",
    "winkeltripel",
];

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

/// How long a metre on the ground is on a map of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scale {
    /// A cylindrical map at a place.
    At {
        /// Metres on the map of a metre eastward and of a metre northward.
        factors: [f64; 2],
        /// Longitude from Greenwich and latitude of the place \[degrees\].
        degrees: [f64; 2],
    },
    /// Another map of the world.
    World,
}

impl Globe {
    pub const WGS_84: Globe = Globe { axis: 6_378_137.0, inverse_flattening: 298.257_223_563, meridian: 0.0 };

    /// The square of the eccentricity.
    fn squared(&self) -> f64 {
        let f = if self.inverse_flattening > 1.0 { 1.0 / self.inverse_flattening } else { 0.0 };
        f * (2.0 - f)
    }

    /// The radius of a parallel over the semi-major axis.
    fn parallel(&self, latitude: f64) -> f64 {
        latitude.cos() / (1.0 - self.squared() * latitude.sin().powi(2)).sqrt()
    }

    /// atanh(e sin(phi)) / e, which on a sphere is sin(phi).
    fn stretched(&self, latitude: f64) -> f64 {
        let e = self.squared().sqrt();
        if e == 0.0 { latitude.sin() } else { (e * latitude.sin()).atanh() / e }
    }
}

impl Scale {
    /// The scale at a place of a map \[m\]; `None` of a method that is no map of the world.
    ///
    /// With m = cos(phi) / sqrt(1 - e^2 sin^2(phi)), m_0 that of the standard parallel or the scale factor: m_0 / m eastward;
    /// northward the same (Mercator), m / m_0 (equal area), 1 (equidistant), or dy / dphi over the radius of the meridian
    /// (maps of the web, a sphere's formula on an ellipsoid). J. P. Snyder, Map projections, USGS Professional Paper 1395
    /// (1987).
    pub fn of(map: &Projection, globe: Globe, place: [f64; 2]) -> Option<Scale> {
        let method = map.method.as_str();
        if WORLD.contains(&method) {
            return Some(Scale::World);
        }
        if ![MERCATOR, PSEUDO_MERCATOR, EQUIDISTANT, EQUAL_AREA].contains(&method) {
            return None;
        }
        let standard = match map.own(PARALLEL_1).filter(|_| method != PSEUDO_MERCATOR) {
            Some(parallel) => globe.parallel(parallel.to_radians()),
            None => map.value(SCALE),
        };
        let north = (place[1] - map.value(NORTHING)) / globe.axis;
        let latitude = latitude(|latitude| northing(map, globe, standard, latitude), north);
        let along = globe.parallel(latitude);
        let eastward = standard / along;
        let northward = match method {
            MERCATOR => eastward,
            EQUAL_AREA => along / standard,
            EQUIDISTANT => 1.0,
            _ => {
                let squared = globe.squared();
                (1.0 - squared * latitude.sin().powi(2)).powf(1.5) / ((1.0 - squared) * latitude.cos())
            }
        };
        let east = (place[0] - map.value(EASTING)) / (globe.axis * standard);
        let longitude = globe.meridian + map.value(LONGITUDE) + east.to_degrees();
        Some(Scale::At { factors: [eastward, northward], degrees: [longitude, latitude.to_degrees()] })
    }

    /// By how much lengths are wrong at most, as a share of the length on the ground; endless where that is not computed.
    pub fn error(&self) -> f64 {
        match self {
            Scale::At { factors, .. } => factors.iter().map(|k| (k - 1.0).abs()).fold(0.0, f64::max),
            Scale::World => f64::INFINITY,
        }
    }
}

/// The northing of a latitude over the semi-major axis.
fn northing(map: &Projection, globe: Globe, standard: f64, latitude: f64) -> f64 {
    let (sine, squared) = (latitude.sin(), globe.squared());
    match map.method.as_str() {
        PSEUDO_MERCATOR => sine.atanh(),
        MERCATOR => standard * (sine.atanh() - squared * globe.stretched(latitude)),
        EQUAL_AREA => {
            let area = sine / (1.0 - squared * sine * sine) + globe.stretched(latitude);
            0.5 * (1.0 - squared) * area / standard
        }
        // The arc of the meridian to 0.2 degrees.
        _ => latitude - map.value(LATITUDE).to_radians(),
    }
}

/// The latitude of a northing, which grows with it, by halving \[radians\].
fn latitude(northing: impl Fn(f64) -> f64, wanted: f64) -> f64 {
    let [mut low, mut high] = [-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2];
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if northing(middle) < wanted { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use crate::Remark;
    use crate::raster::tests::sampled;
    use crate::raster::{Crs, Declared, Raster, Reading};
    use std::path::Path;

    fn refused(raster: Raster) -> String {
        raster.checked(Path::new("dem.tif")).unwrap_err().to_string()
    }

    /// A raster of 10 m cells with its centre at a place of a system.
    fn placed(crs: &Crs, [x, y]: [f64; 2]) -> Raster {
        let side = |at: f64| at - 10.0;
        Raster {
            west: side(x),
            south: side(y),
            cell: 10.0,
            crs: Some(crs.clone()),
            ..sampled(2, 2, |x, _| x)
        }
    }

    #[test]
    fn maps_of_the_world_are_refused_where_lengths_are_wrong() {
        // Coordinates of 9 degrees east and 45 north, by PROJ's formulae on WGS 84.
        let [x, mercator] = [1_001_875.417, 5_591_295.918];
        for (code, place, text) in [
            (3857, [x, 5_621_521.486], "EPSG:3857"),
            (3395, [x, mercator], "lengths are 41.2 % too long here"),
            (3832, [x - 16_697_923.618, mercator], "-t_srs EPSG:32632 -tr 7.1 7.1"),
            (4087, [x, 4_984_944.378], "too long eastward and true northward"),
            (32662, [x, 5_009_377.086], "eastward"),
            (6933, [868_300.0, 5_170_000.0], "too short northward"),
            (3994, [-7_650_000.0, 4_220_000.0], "EPSG:3994"),
        ] {
            let crs = Crs { epsg: Some(code), wkt: None };
            let message = refused(placed(&crs, place));
            assert!(
                message.contains(text) && message.contains("gdalwarp -t_srs EPSG:32"),
                "{code}: {message}"
            );
        }
        for code in [53004, 54004, 54001, 54034] {
            let message = refused(placed(&Crs::coded(code, None).unwrap(), [x, 5.5e6]));
            assert!(message.contains("too long"), "{code}: {message}");
        }
        for code in [53009, 54008, 54009, 54030] {
            let message = refused(placed(&Crs::coded(code, None).unwrap(), [x, 5.5e6]));
            assert!(
                message.contains("a map of the world") && message.contains("gdalwarp"),
                "{code}: {message}"
            );
        }
        let web = r#"PROJCS["WGS_1984_Web_Mercator",GEOGCS["GCS_WGS_1984_Major_Auxiliary_Sphere",DATUM["D_WGS_1984_Major_Auxiliary_Sphere",SPHEROID["WGS_1984_Major_Auxiliary_Sphere",6378137.0,0.0]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Mercator"],PARAMETER["False_Easting",0.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",0.0],PARAMETER["Standard_Parallel_1",0.0],UNIT["Meter",1.0]]"#;
        let message = refused(placed(&Crs::parse(web).unwrap(), [x, 5_621_521.486]));
        assert!(message.contains("WGS_1984_Web_Mercator") && message.contains("41.4 %"), "{message}");
    }

    #[test]
    fn a_mercator_is_allowed_where_lengths_are_true_and_warned_of_where_nearly() {
        let read = |code, place| {
            let raster = placed(&Crs { epsg: Some(code), wkt: None }, place);
            let path = Path::new("dem.asc");
            Reading::in_metres(path, raster, Declared::default(), None, Vec::new()).map(|read| read.notes)
        };
        // 2, 7 and 12 degrees south.
        assert_eq!(read(3395, [1.2e7, -221_200.0]).unwrap(), []);
        let notes = read(3395, [1.2e7, -775_600.0]).unwrap();
        assert!(
            matches!(&*notes, [Remark::Warning(text)] if text.contains("EPSG:3395") && text.contains("0.7 % too long")),
            "{notes:?}"
        );
        assert!(read(3395, [1.2e7, -1_335_000.0]).is_err());
        // New Zealand's map of 41 degrees south, and maps that are not of the world.
        assert_eq!(read(3994, [6.3e6, -3_767_132.0]).unwrap(), []);
        for (code, place) in [(32632, [5e5, 5e6]), (31287, [4e5, 4e5]), (3035, [4.3e6, 2.7e6])] {
            assert_eq!(read(code, place).unwrap(), [], "{code}");
        }
    }
}
