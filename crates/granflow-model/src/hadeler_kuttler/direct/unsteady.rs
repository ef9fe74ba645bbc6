//! Why a growing pile comes to no equilibrium.

/// Why there is no equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsteady<const D: usize> {
    /// Sand is poured on a piece of the table that it cannot leave.
    Enclosed {
        /// A cell with a source there.
        cell: [usize; D],
    },
    /// Sand rolls into a cell in which the surface has no slope.
    Trapped {
        /// The cell.
        cell: [usize; D],
    },
    /// The table is steeper than sand can lie.
    Steep {
        /// Where.
        node: [usize; D],
        /// |grad b| there.
        slope: f64,
    },
}

impl<const D: usize> core::fmt::Display for Unsteady<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Enclosed { cell } => write!(
                f,
                "sand poured on cell {cell:?} can never leave the table: there is no open edge on its piece of it; open one, or end the run at a time"
            ),
            Self::Trapped { cell } => write!(
                f,
                "the surface at cell {cell:?} is level, sand would gather there without end: take smaller cells, the table is about one cell wide there"
            ),
            Self::Steep { node, slope } => write!(
                f,
                "the table rises with slope {slope} at node {node:?}, sand lies at slopes up to 1: make the table less steep"
            ),
        }
    }
}

impl<const D: usize> core::error::Error for Unsteady<D> {}
