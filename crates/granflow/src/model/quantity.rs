//! A quantity of a model as the files know it: names, units, and where its values stand.

/// The units of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// The papers' scaling: pure numbers.
    Scaled,
    /// Metres and seconds.
    Si,
}

impl Units {
    /// Unit of lengths along the axes, after UDUNITS.
    #[must_use]
    pub const fn length(self) -> &'static str {
        match self {
            Self::Scaled => "1",
            Self::Si => "m",
        }
    }

    /// Unit of times, after UDUNITS.
    #[must_use]
    pub const fn time(self) -> &'static str {
        match self {
            Self::Scaled => "1",
            Self::Si => "s",
        }
    }

    /// The unit that a figure writes: `si`, or nothing in the papers' scaling.
    #[must_use]
    pub const fn label(self, si: &str) -> &str {
        match self {
            Self::Scaled => "",
            Self::Si => si,
        }
    }
}

/// Where the values of a quantity stand; x runs fastest everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum At {
    /// At the centres of the cells.
    Cells,
    /// At the nodes, one more than cells along each axis.
    Nodes,
    /// On the faces across x: as many as nodes along x, in rows of cells.
    FacesX,
    /// On the faces across y: as many as cells along x, in rows of nodes.
    FacesY,
}

/// How a quantity changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// It is kept at every output instant.
    Series,
    /// One map for the whole run, or for its end.
    Map,
    /// It is known before the run and does not change.
    Fixed,
}

/// A quantity of a model, as a variable of `result.nc`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity {
    /// Name in all files.
    pub name: &'static str,
    /// What it is, in words.
    pub long_name: &'static str,
    /// Units after UDUNITS, in the papers' scaling and in SI.
    pub units: [&'static str; 2],
    /// Where its values stand.
    pub at: At,
    /// How it changes.
    pub kind: Kind,
    /// Is the largest value of the map a number of `summary.json`, called `<name>_max`?
    pub maximum: bool,
    /// Is it stored in 64 bits whatever precision the case asks for?
    pub exact: bool,
    /// Does a fixed quantity stand among the maps of csv and vtk files too?
    pub tabulated: bool,
    /// Is it there only if the case asks for it?
    pub on_demand: bool,
}

impl Quantity {
    const fn new(
        kind: Kind,
        name: &'static str,
        long_name: &'static str,
        units: [&'static str; 2],
    ) -> Quantity {
        let (maximum, exact, tabulated, on_demand) = (false, false, false, false);
        Quantity { name, long_name, units, at: At::Cells, kind, maximum, exact, tabulated, on_demand }
    }

    /// A series in the cells; `units` are those in the papers' scaling and in SI.
    #[must_use]
    pub const fn series(name: &'static str, long_name: &'static str, units: [&'static str; 2]) -> Quantity {
        Self::new(Kind::Series, name, long_name, units)
    }

    /// A map of the cells; `units` as in [`Quantity::series`].
    #[must_use]
    pub const fn map(name: &'static str, long_name: &'static str, units: [&'static str; 2]) -> Quantity {
        Self::new(Kind::Map, name, long_name, units)
    }

    /// What is known before the run, in the cells; `units` as in [`Quantity::series`].
    #[must_use]
    pub const fn fixed(name: &'static str, long_name: &'static str, units: [&'static str; 2]) -> Quantity {
        Self::new(Kind::Fixed, name, long_name, units)
    }

    /// The same with its values elsewhere.
    #[must_use]
    pub const fn at(self, at: At) -> Quantity {
        Quantity { at, ..self }
    }

    /// The same with [`Quantity::maximum`].
    #[must_use]
    pub const fn with_maximum(self) -> Quantity {
        Quantity { maximum: true, ..self }
    }

    /// The same with [`Quantity::on_demand`].
    #[must_use]
    pub const fn on_demand(self) -> Quantity {
        Quantity { on_demand: true, ..self }
    }

    /// The same with [`Quantity::exact`].
    #[must_use]
    pub const fn exact(self) -> Quantity {
        Quantity { exact: true, ..self }
    }

    /// The same with [`Quantity::tabulated`].
    #[must_use]
    pub const fn tabulated(self) -> Quantity {
        Quantity { tabulated: true, ..self }
    }

    /// Its units in a run.
    #[must_use]
    pub const fn units_in(&self, units: Units) -> &'static str {
        match units {
            Units::Scaled => self.units[0],
            Units::Si => self.units[1],
        }
    }
}
