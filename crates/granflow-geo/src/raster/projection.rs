//! Map projections under one name for each method and parameter, whatever wrote them: OGC, ESRI or WKT 2.

use super::register::plain;
use super::wkt::Node;

/// A method with its parameters in metres, degrees and ratios.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Projection {
    pub method: String,
    parameters: Vec<(String, f64)>,
}

/// Methods by their name without blanks and underscores; others go by the name itself.
const METHODS: [(&str, &[&str]); 16] = [
    (TRANSVERSE_MERCATOR, &["transversemercator", "gausskruger", "transversemercatorcomplex"]),
    (
        LAMBERT_CONIC,
        &[
            "lambertconformalconic",
            "lambertconformalconic1sp",
            "lambertconformalconic2sp",
            "lambertconicconformal1sp",
            "lambertconicconformal2sp",
        ],
    ),
    (
        POLAR,
        &[
            "polarstereographic",
            "polarstereographicvarianta",
            "polarstereographicvariantb",
            "stereographicnorthpole",
            "stereographicsouthpole",
        ],
    ),
    (OBLIQUE_STEREOGRAPHIC, &["obliquestereographic", "doublestereographic"]),
    (LAMBERT_AZIMUTHAL, &["lambertazimuthalequalarea"]),
    (ALBERS, &["albersconicequalarea", "albers", "albersequalarea"]),
    (
        HOTINE_ORIGIN,
        &[
            "hotineobliquemercator",
            "hotineobliquemercatorazimuthnaturalorigin",
            "rectifiedskeworthomorphicnaturalorigin",
            "hotineobliquemercatorvarianta",
        ],
    ),
    (
        HOTINE_CENTRE,
        &[
            "hotineobliquemercatorazimuthcenter",
            "rectifiedskeworthomorphiccenter",
            "hotineobliquemercatorvariantb",
        ],
    ),
    (MERCATOR, &["mercator", "mercator1sp", "mercator2sp", "mercatorvarianta", "mercatorvariantb"]),
    (PSEUDO_MERCATOR, &["mercatorauxiliarysphere", "popularvisualisationpseudomercator"]),
    (
        EQUIDISTANT,
        &["equirectangular", "platecarree", "equidistantcylindrical", "equidistantcylindricalspherical"],
    ),
    (EQUAL_AREA, &["cylindricalequalarea", "lambertcylindricalequalarea"]),
    (CASSINI, &["cassinisoldner", "cassini"]),
    (POLYCONIC, &["polyconic", "americanpolyconic"]),
    (KROVAK, &["krovak", "krovaknorthorientated"]),
    ("lambert_belgium", &["lambertconformalconic2spbelgium", "lambertconicconformal2spbelgium"]),
];

pub(super) const MERCATOR: &str = "mercator";
/// The method of web maps.
pub(super) const PSEUDO_MERCATOR: &str = "pseudo_mercator";
pub(super) const EQUIDISTANT: &str = "equirectangular";
pub(super) const EQUAL_AREA: &str = "cylindrical_equal_area";
pub(super) const TRANSVERSE_MERCATOR: &str = "transverse_mercator";
pub(super) const LAMBERT_CONIC: &str = "lambert_conformal_conic";
pub(super) const LAMBERT_AZIMUTHAL: &str = "lambert_azimuthal_equal_area";
pub(super) const ALBERS: &str = "albers";
pub(super) const POLAR: &str = "polar_stereographic";
pub(super) const OBLIQUE_STEREOGRAPHIC: &str = "oblique_stereographic";
pub(super) const HOTINE_ORIGIN: &str = "hotine_natural_origin";
pub(super) const HOTINE_CENTRE: &str = "hotine_centre";
pub(super) const CASSINI: &str = "cassini_soldner";
pub(super) const POLYCONIC: &str = "polyconic";
const KROVAK: &str = "krovak";

pub(super) const LATITUDE: &str = "latitude of origin";
pub(super) const LONGITUDE: &str = "longitude of origin";
pub(super) const PARALLEL_1: &str = "first standard parallel";
pub(super) const PARALLEL_2: &str = "second standard parallel";
const PSEUDO_PARALLEL: &str = "pseudo standard parallel";
pub(super) const AZIMUTH: &str = "azimuth";
pub(super) const GRID_ANGLE: &str = "angle of the grid";
pub(super) const SCALE: &str = "scale factor";
pub(super) const EASTING: &str = "false easting";
pub(super) const NORTHING: &str = "false northing";

/// Parameters by their name without blanks and underscores; others go by the name itself.
const PARAMETERS: [(&str, &[&str]); 10] = [
    (
        LATITUDE,
        &[
            "latitudeoforigin",
            "latitudeofcenter",
            "latitudeofnaturalorigin",
            "latitudeoffalseorigin",
            "latitudeofprojectioncentre",
        ],
    ),
    (
        LONGITUDE,
        &[
            "centralmeridian",
            "longitudeofcenter",
            "longitudeofnaturalorigin",
            "longitudeoffalseorigin",
            "longitudeofprojectioncentre",
            "longitudeoforigin",
            "straightverticallongitudefrompole",
        ],
    ),
    (PARALLEL_1, &["standardparallel1", "latitudeof1ststandardparallel", "latitudeofstandardparallel"]),
    (PARALLEL_2, &["standardparallel2", "latitudeof2ndstandardparallel"]),
    (AZIMUTH, &["azimuth", "azimuthofinitialline", "azimuthatprojectioncentre", "colatitudeofconeaxis"]),
    (GRID_ANGLE, &["rectifiedgridangle", "anglefromrectifiedtoskewgrid"]),
    (
        SCALE,
        &[
            "scalefactor",
            "scalefactoratnaturalorigin",
            "scalefactoratprojectioncentre",
            "scalefactoroninitialline",
            "scalefactoronpseudostandardparallel",
        ],
    ),
    (PSEUDO_PARALLEL, &["pseudostandardparallel1", "latitudeofpseudostandardparallel"]),
    (EASTING, &["falseeasting", "eastingatfalseorigin", "eastingatprojectioncentre"]),
    (NORTHING, &["falsenorthing", "northingatfalseorigin", "northingatprojectioncentre"]),
];

/// The name that stands for all of its spellings.
fn common(name: &str, table: &[(&'static str, &[&str])]) -> String {
    let plain = plain(name);
    let known = table.iter().find(|(_, spellings)| spellings.contains(&&*plain));
    known.map_or(plain, |(name, _)| (*name).to_string())
}

impl Projection {
    /// The projection of a projected system whose coordinates count `metres` and whose angles count `degrees`.
    pub fn of(crs: &Node, metres: f64, degrees: f64) -> Option<Projection> {
        let method = crs.find(&["PROJECTION", "METHOD"])?.text(0)?;
        let mut method = common(method, &METHODS);
        if crs
            .child(&["EXTENSION"])
            .and_then(|n| n.text(1))
            .is_some_and(|proj| proj.contains("+nadgrids=@null"))
        {
            method = PSEUDO_MERCATOR.into();
        }
        let mut found = Vec::new();
        parameters(crs, &mut found);
        let value = |node: &&Node| {
            let name = common(node.text(0)?, &PARAMETERS);
            let unit =
                node.child(&["LENGTHUNIT", "ANGLEUNIT", "SCALEUNIT", "UNIT"]).and_then(|unit| unit.number(1));
            let factor = match &*name {
                SCALE => 1.0,
                EASTING | NORTHING => unit.unwrap_or(metres),
                _ => unit.map_or(degrees, f64::to_degrees),
            };
            Some((name, node.number(1)? * factor))
        };
        let parameters = found.iter().filter_map(value).collect();
        let mut projection = Projection { method, parameters }.normal();
        if projection.method == KROVAK {
            projection.orient(crs);
        }
        Some(projection)
    }

    /// One way of saying where there are several.
    fn normal(mut self) -> Projection {
        let [first, second] = [PARALLEL_1, PARALLEL_2].map(|name| self.own(name));
        match (&*self.method, first, second) {
            // ESRI gives the parallel of true scale, OGC calls it the latitude of origin.
            ("stereographic", ..) if (self.value(LATITUDE).abs() - 90.0).abs() < 1e-6 => {
                self.method = POLAR.into()
            }
            (POLAR, Some(parallel), _) => {
                self.parameters.retain(|(name, _)| name != LATITUDE && name != PARALLEL_1);
                self.parameters.push((LATITUDE.into(), parallel));
            }
            // A cone that touches: ESRI names the parallel and the latitude, which are the same.
            (LAMBERT_CONIC, Some(parallel), None) if Some(parallel) == self.own(LATITUDE) => {
                self.parameters.retain(|(name, _)| name != PARALLEL_1);
            }
            (_, Some(first), Some(second)) if first > second => {
                self.parameters.retain(|(name, _)| name != PARALLEL_1 && name != PARALLEL_2);
                self.parameters.extend([(PARALLEL_1.into(), second), (PARALLEL_2.into(), first)]);
            }
            (PSEUDO_MERCATOR, ..) => self.parameters.retain(|(name, _)| name != "auxiliaryspheretype"),
            _ => {}
        }
        self
    }

    /// Krovak's map counts southward and westward, or with both turned; ESRI says so by a scale of -1, OGC by its axes, WKT 2
    /// by the name of the method.
    fn orient(&mut self, crs: &Node) {
        let named = crs.find(&["METHOD"]).and_then(|method| method.text(0));
        let turned = named.is_some_and(|name| name.contains("North Orientated"));
        let east = crs.child(&["AXIS"]).and_then(|axis| axis.text(1)).is_some_and(|way| way == "EAST");
        let north = match (named, self.own("xscale")) {
            (Some(_), _) => turned,
            (None, Some(scale)) => scale < 0.0,
            (None, None) => east,
        };
        self.parameters.retain(|(name, _)| !["xscale", "yscale", "xyplanerotation"].contains(&&**name));
        self.method = if north { "krovak_north" } else { KROVAK }.into();
    }

    /// The value of a parameter, where it is said.
    pub fn own(&self, name: &str) -> Option<f64> {
        self.parameters.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
    }

    /// The value of a parameter, or what it is where nobody says it.
    pub fn value(&self, name: &str) -> f64 {
        let default = match name {
            SCALE => 1.0,
            GRID_ANGLE => self.own(AZIMUTH).unwrap_or(0.0),
            _ => 0.0,
        };
        self.own(name).unwrap_or(default)
    }

    /// The first thing in which two projections differ.
    pub fn difference(&self, other: &Projection) -> Option<String> {
        if self.method != other.method {
            return Some(format!("projection {} against {}", self.method, other.method));
        }
        let names = self.parameters.iter().chain(&other.parameters).map(|(name, _)| name.as_str());
        names.into_iter().find_map(|name| {
            let [a, b] = [self.value(name), other.value(name)];
            // Whole turns do not count.
            let turn = if matches!(name, AZIMUTH | GRID_ANGLE | LONGITUDE) { 360.0 } else { f64::INFINITY };
            // A millimetre, a ten-millionth of a degree (1 cm), or a billionth of the scale.
            let small = match name {
                SCALE => 1e-9,
                EASTING | NORTHING => 1e-3,
                _ => 1e-7,
            };
            let round = |value: f64| (value * 1e10).round() / 1e10;
            let apart = (a - b).abs();
            (apart.min((apart - turn).abs()) > small)
                .then(|| format!("{name} {} against {}", round(a), round(b)))
        })
    }
}

/// All parameters below a node.
fn parameters<'a>(node: &'a Node, found: &mut Vec<&'a Node>) {
    if node.is("PARAMETER") {
        found.push(node);
    }
    node.children().for_each(|child| parameters(child, found));
}
