//! The scale of maps: how long a metre on the ground is on the map, where it lies.

use super::ground::{self, Globe};
use super::projection::{EASTING, EQUAL_AREA, EQUIDISTANT, LATITUDE, LONGITUDE, MERCATOR, NORTHING};
use super::projection::{PARALLEL_1, PSEUDO_MERCATOR, Projection, SCALE};

/// Maps of the world, by their names without blanks and underscores, whose scale is not computed: they are true to scale on a
/// few lines at most.
const WORLD: [&str; 46] = [
    "adamssquareii",
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
    "peircequincuncial",
    "quarticauthalic",
    "robinson",
    "sinusoidal",
    "times",
    "toblercylindricali",
    "toblercylindricalii",
    "twopointequidistant",
    "vandergrinten",
    "vandergrinteni",
    "verticalnearsideperspective",
    "wagneriv",
    "wagnerv",
    "wagnervii",
    "winkeli",
    "winkelii",
    "winkeltripel",
];

/// How long a metre on the ground is on a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scale {
    /// A map at a place.
    At {
        /// Metres on the map of a metre in two directions at right angles.
        factors: [f64; 2],
        /// The directions, in words.
        ways: [&'static str; 2],
        /// Longitude from Greenwich and latitude of the place \[degrees\].
        degrees: [f64; 2],
    },
    /// A map of the world whose scale is not computed.
    World,
}

/// The directions of cylindrical maps.
const COMPASS: [&str; 2] = ["eastward", "northward"];
/// Those in which a map stretches most and least.
const PRINCIPAL: [&str; 2] = ["one way", "across it"];

impl Scale {
    /// The scale at a place of a map \[m\]; `None` of a method that is not known.
    pub fn of(map: &Projection, globe: Globe, place: [f64; 2]) -> Option<Scale> {
        let method = map.method.as_str();
        if WORLD.contains(&method) {
            return Some(Scale::World);
        }
        if [MERCATOR, PSEUDO_MERCATOR, EQUIDISTANT, EQUAL_AREA].contains(&method) {
            return Some(Scale::cylindrical(map, globe, place));
        }
        let (factors, degrees) = ground::factors(map, globe, place)?;
        Some(Scale::At { factors, ways: PRINCIPAL, degrees })
    }

    /// The scale of a cylindrical map.
    ///
    /// With m = cos(phi) / sqrt(1 - e^2 sin^2(phi)), m_0 that of the standard parallel or the scale factor: m_0 / m eastward;
    /// northward the same (Mercator), m / m_0 (equal area), 1 (equidistant), or dy / dphi over the radius of the meridian
    /// (maps of the web, a sphere's formula on an ellipsoid). J. P. Snyder, Map projections, USGS Professional Paper 1395
    /// (1987).
    fn cylindrical(map: &Projection, globe: Globe, place: [f64; 2]) -> Scale {
        let method = map.method.as_str();
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
        let degrees = [longitude, latitude.to_degrees()];
        Scale::At { factors: [eastward, northward], ways: COMPASS, degrees }
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
    use crate::raster::{Crs, Raster};
    use std::path::Path;

    fn refused(raster: Raster) -> String {
        raster.true_to_scale(Path::new("dem.tif"), &mut Vec::new()).unwrap_err().to_string()
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
            let mut notes = Vec::new();
            raster.true_to_scale(Path::new("dem.asc"), &mut notes).map(|()| notes)
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

    #[test]
    fn the_factors_of_maps_are_those_of_proj() {
        // tissot_semimajor and tissot_semiminor of pyproj 3.7.2 (PROJ 9.5.1); `validation/scales.py` compares all systems.
        for (code, place, expected) in [
            (32632, [500000.000, 5094047.492], [0.999600007, 0.999599993]),
            (32632, [1985530.771, 5797224.402], [1.026812301, 1.026812301]),
            (31287, [147618.347, 372075.839], [0.999672652, 0.999672631]),
            (3035, [4321000.000, 2654053.480], [1.000857559, 0.999143176]),
            (3035, [4948738.512, 5055028.417], [1.012185739, 0.987960965]),
            (3034, [4000000.000, 2585140.621], [0.965725235, 0.965725235]),
            (5070, [-760465.745, 1923013.980], [1.009113707, 0.990968603]),
            (3413, [0.000, -2750247.670], [1.017495214, 1.017495214]),
            (3031, [284571.723, 1613886.439], [0.989625552, 0.989625537]),
            (28992, [197981.142, 334568.531], [1.000020499, 1.000020478]),
            (2193, [1359473.679, 5123750.873], [1.000311600, 1.000311600]),
            (5880, [4342200.070, 8888164.155], [1.005352438, 0.999999951]),
            (2056, [2604637.321, 1149715.000], [1.000031073, 1.000031073]),
        ] {
            let found = Crs { epsg: Some(code), wkt: None }.factors(place).unwrap();
            let error = found.iter().zip(expected).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
            assert!(error < 1e-6, "{code}: {found:?} against {expected:?}");
        }
        // Axes that count southward and westward, and a method without an inverse here.
        for code in [2065, 2048, 27200] {
            assert_eq!(Crs { epsg: Some(code), wkt: None }.factors([1e5, 1e5]), None, "{code}");
        }
    }

    #[test]
    fn maps_far_from_their_origin_are_refused_or_warned_of() {
        let judged = |code, place| {
            let raster = placed(&Crs { epsg: Some(code), wkt: None }, place);
            let mut notes = Vec::new();
            let judged = raster.true_to_scale(Path::new("dem.tif"), &mut notes);
            judged.map(|()| notes).map_err(|error| error.to_string())
        };
        // Zone 32 in the zone beside it, in Kiev and in the Urals.
        assert_eq!(judged(32632, [1.1e6, 5e6]).unwrap(), []);
        assert_eq!(judged(32632, [1.9e6, 5.7e6]).unwrap_err().matches("long here").count(), 1);
        assert!(judged(32632, [3.5e6, 7e6]).unwrap_err().contains("gdalwarp -t_srs EPSG:326"));
        // Europe's equal areas: true at the Alps, wrong in Lapland, more so on the Canaries.
        assert_eq!(judged(3035, [4.3e6, 2.7e6]).unwrap(), []);
        let notes = judged(3035, [5.0e6, 5.2e6]).unwrap();
        assert!(matches!(&*notes, [Remark::Warning(text)] if text.contains("across it")), "{notes:?}");
        let canaries = judged(3035, [1.6e6, 9.5e5]).unwrap_err();
        assert!(canaries.contains("too long one way and") && canaries.contains("EPSG:32628"), "{canaries}");
        // A cone of 35 and 65 degrees is 3 % too short half way between.
        assert!(judged(3034, [4e6, 2.6e6]).unwrap_err().contains("too short here"));
    }
}
