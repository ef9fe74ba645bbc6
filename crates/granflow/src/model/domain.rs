//! A model and the places it flows on, as everything after a run sees them.

use super::quantity::{Kind, Quantity, Units};
#[cfg(all(feature = "geo", feature = "files"))]
use crate::output::outlines::Outline;
#[cfg(feature = "files")]
use crate::output::{netcdf::Crs, report::KeyFigure, summary::Summary};
#[cfg(feature = "geo")]
use crate::raster::Raster;
use std::any::Any;
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

#[cfg(feature = "figures")]
use super::{drawing::Drawing, result_file::ResultFile, view::View};
#[cfg(feature = "figures")]
use crate::output::{
    figures::{FigureError, Picture},
    style::Style,
};

/// Maps by the names of their quantities, x fastest, the first row in the south.
pub type Maps = Vec<(&'static str, Vec<f64>)>;

/// A model: one static value, in the folder of the model.
///
/// From outside this library write `Model { name: .., quantities: .., ..Model::PLAIN }`.
#[derive(Debug)]
pub struct Model {
    /// Name, as in the case file and in `result.nc`.
    pub name: &'static str,
    /// All quantities of its files; series in the order of the frames.
    pub quantities: &'static [Quantity],
    /// Where mass leaves, in the order of the ledger: left, right, bottom, top, and inside the grid.
    pub outlets: [&'static str; 5],
    /// Words for people.
    pub words: Words,
    /// Is the last instant of the series a result of its own, so that csv files show it beside the maps and vtk
    /// files show the maps beside the series? A pile that grows has no other; an avalanche has a map of its
    /// deposit.
    pub last_instant: bool,
    /// The name of a scheme as figures write it.
    pub scheme_title: fn(&str) -> String,
    #[cfg(feature = "files")]
    /// The rows of the table of key figures of a run.
    pub key_figures: fn(&Summary) -> Vec<KeyFigure>,
    #[cfg(feature = "files")]
    /// What to know before the numbers of a run are trusted.
    pub warnings: fn(&Model, &Summary) -> Vec<String>,
    /// What is drawn of it; `None` for nothing.
    #[cfg(feature = "figures")]
    pub pictures: Option<&'static dyn Pictures>,
}

impl Model {
    /// A model without quantities and pictures that leaves the grid over its sides and into nodata.
    pub const PLAIN: Model = Model {
        name: "",
        quantities: &[],
        outlets: ["left", "right", "bottom", "top", "nodata"],
        words: Words { wet: "wet cells", fastest: "speed" },
        last_instant: false,
        scheme_title: str::to_owned,
        #[cfg(feature = "files")]
        key_figures: KeyFigure::of_any,
        #[cfg(feature = "files")]
        warnings: |_, _| Vec::new(),
        #[cfg(feature = "figures")]
        pictures: None,
    };

    /// A quantity by its name.
    #[must_use]
    pub fn quantity(&self, name: &str) -> Option<&'static Quantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }

    /// Its quantities of one kind.
    pub fn of_kind(&self, kind: Kind) -> impl Iterator<Item = &'static Quantity> + use<> {
        self.quantities.iter().filter(move |quantity| quantity.kind == kind)
    }
}

/// Words of a model for progress and tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Words {
    /// What `wet_cells` counts, as in "12 wet cells".
    pub wet: &'static str,
    /// What stands before the largest speed, as in "speed 1.2".
    pub fastest: &'static str,
}

/// What lies under the cells of a run, and with it the model: a chute, a mountain, a table.
///
/// A domain says what the files need beyond the cells' centres; everything has a default but the model.
pub trait Domain: Any + fmt::Debug + Send + Sync {
    /// The model.
    fn model(&self) -> &'static Model;

    /// Units of everything in the files.
    fn units(&self) -> Units {
        Units::Scaled
    }

    /// Are x and y the coordinates of a map projection?
    fn projected(&self) -> bool {
        false
    }

    /// Is this series of the model kept here, in one or two dimensions?
    fn keeps(&self, _series: &Quantity, _dimensions: usize) -> bool {
        true
    }

    /// Nodes along x and y, where quantities stand on them or on faces; none along y in one dimension.
    fn nodes(&self) -> Option<[&[f64]; 2]> {
        None
    }

    /// What a user should know of the files that were read for it, one sentence each, beginning with `note: ` or
    /// `warning: `.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// What else a result file says of it, as names and texts of global attributes.
    fn attributes(&self) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// Elevation of the cells; where it is NaN no quantity of the cells has a value.
    fn elevation(&self) -> Option<&[f64]> {
        None
    }

    /// The coordinate reference system of x and y.
    #[cfg(feature = "files")]
    fn crs(&self) -> Option<Crs> {
        None
    }

    /// Volume per plan area of a layer of thickness 1 in these cells: 1 over the cosine of the slope on terrain, where a
    /// thickness is normal to the bed and an area is one of the map; 1 on a chute, and where there is no cell.
    fn per_plan_area(&self, cells: &[Option<usize>]) -> Vec<f64> {
        vec![1.0; cells.len()]
    }

    /// Dynamic pressure of a speed along the bed (kPa); NaN where the density is not known.
    fn pressure(&self, _speed: f64) -> f64 {
        f64::NAN
    }

    /// The cells as a raster that can be written for a geographic information system.
    #[cfg(feature = "geo")]
    fn raster(&self) -> Option<&Raster> {
        None
    }

    /// The fixed quantities by name, in the order of `result.nc`; empty ones are left out of the files.
    fn fixed(&self) -> Vec<(&'static str, Cow<'_, [f64]>)> {
        Vec::new()
    }

    /// The same domain with the elevation of its cells, where it is kept elsewhere while a run computes.
    fn with_bed(&self, _elevation: &dyn Fn() -> Vec<f64>) -> Option<Arc<dyn Domain>> {
        None
    }

    /// Maps and numbers of the summary that follow from the maps, given the cells' centres along x and y.
    #[cfg(feature = "files")]
    fn derive(&self, _centres: [&[f64]; 2], _maps: &mut Maps, _summary: &mut Summary) {}

    /// The areas that `outlines.geojson` shows.
    #[cfg(all(feature = "geo", feature = "files"))]
    fn outlines(&self, _maps: &Maps) -> Vec<Outline> {
        Vec::new()
    }
}

impl dyn Domain {
    /// The domain as what it is, for the functions of its own model.
    #[must_use]
    pub fn get<T: Domain>(&self) -> Option<&T> {
        let any: &dyn Any = self;
        any.downcast_ref()
    }
}

/// What is drawn of a model, from a run or from its `result.nc`.
#[cfg(feature = "figures")]
pub trait Pictures: fmt::Debug + Sync {
    /// The variables of `result.nc` without which it is no result of this model.
    fn needed(&self) -> &'static [&'static str];

    /// The domain of a result, with these cell centres along x and y.
    ///
    /// # Errors
    /// What is wrong with the file.
    fn domain(&self, file: &ResultFile, centres: [&[f64]; 2]) -> Result<Arc<dyn Domain>, String>;

    /// The series that figures show, in one or two dimensions.
    fn shown(&self, domain: &dyn Domain, dimensions: usize) -> &'static [&'static str];

    /// The standard figures.
    fn figures<'a>(&self, view: &'a View<'a>, domain: &'a dyn Domain) -> Vec<Drawing<'a>>;

    /// The colours in which the figures show maps, by their names; `map` gives those that there are.
    fn styles<'a>(
        &self,
        _domain: &dyn Domain,
        _map: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Vec<(&'static str, Style)> {
        Vec::new()
    }

    /// The line down which the mass went, from its begin on; none where there is none.
    fn path(&self, _view: &View<'_>, _domain: &dyn Domain) -> Option<Vec<[f64; 2]>> {
        None
    }

    /// The series that the animation shows.
    fn animated(&self) -> &'static [&'static str];

    /// What all pictures of the animation share, found from the instants that it shows.
    ///
    /// # Errors
    /// That of an instant which cannot be read.
    fn scene<'a>(
        &self,
        view: &'a View<'a>,
        domain: &'a dyn Domain,
        instants: &mut Instants<'_>,
    ) -> Result<Box<dyn Scene + 'a>, crate::output::Error>;
}

/// The series of [`Pictures::animated`] at one instant after the other, read as they are asked for.
#[cfg(feature = "figures")]
pub type Instants<'i> = dyn Iterator<Item = Result<Vec<Vec<f64>>, crate::output::Error>> + 'i;

/// An animation that is still to be drawn.
#[cfg(feature = "figures")]
pub trait Scene: Sync {
    /// The picture of an instant, from the series of [`Pictures::animated`]; all have the same size.
    ///
    /// # Errors
    /// [`FigureError`] if it cannot be drawn.
    fn draw(&self, time: f64, fields: &[Vec<f64>]) -> Result<Picture, FigureError>;
}
