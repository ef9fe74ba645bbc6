//! A table laid out: its cells have a size, its nodes a height, and the rays along which sand rolls are known.

use crate::grid::Grid;
use crate::hadeler_kuttler::direct::{self, Equilibrium, Unsteady};
use crate::hadeler_kuttler::scheme::HadelerKuttler;
use crate::hadeler_kuttler::table::Table;
use crate::hadeler_kuttler::{Ground, Pile, Source};
use crate::scheme::Boundary;
use crate::simulation::{BuildError, Simulation, StepSize};

/// Where sand is poured: what the simulation of a table needs beside source and state.
///
/// Fields in the cells and at the nodes are x fastest; nodes outnumber cells by one along each axis.
#[derive(Clone, Debug)]
pub struct Site<const D: usize> {
    /// The table.
    pub table: Table<D>,
    /// Its lower corner.
    pub origin: [f64; D],
    /// Cell size along each axis.
    pub size: [f64; D],
    /// Height b of the table at the nodes.
    pub bed: Vec<f64>,
    /// Shares of the source along the axes, in the cells.
    shares: Vec<[f64; D]>,
}

impl<const D: usize> Site<D> {
    /// A table of this height, with the transport rays of the highest pile on it ([`direct::rays`], eq. 47).
    pub fn new(table: Table<D>, origin: [f64; D], size: [f64; D], bed: Vec<f64>) -> Self {
        let shares = direct::rays(&table, size, &direct::surface(&table, size, &bed));
        Site { table, origin, size, bed, shares }
    }

    /// A level table with a corner at the origin.
    pub fn level(table: Table<D>, size: [f64; D]) -> Self {
        let nodes = table.nodes().iter().product();
        Self::new(table, [0.0; D], size, vec![0.0; nodes])
    }

    /// The grid of the scheme.
    pub fn grid(&self) -> Grid<D> {
        Grid {
            cells: self.table.nodes(),
            origin: self.origin,
            size: self.size,
            boundary: [[Boundary::Absorbing; 2]; D],
        }
    }

    /// Number of a cell of the scheme's grid among those of the table, of which there is one less along each axis.
    pub fn cell(&self, index: [usize; D]) -> Option<usize> {
        let cells = self.table.cells();
        let within = (0..D).all(|k| index[k] < cells[k]);
        within.then(|| (0..D).rev().fold(0, |sum, k| sum * cells[k] + index[k]))
    }

    /// Number of a node.
    pub fn node(&self, index: [usize; D]) -> usize {
        let nodes = self.table.nodes();
        (0..D).rev().fold(0, |sum, k| sum * nodes[k] + index[k])
    }

    /// The ground of a cell.
    pub fn ground(&self, index: [usize; D]) -> Ground<D, f64> {
        self.table.ground(index, self.bed[self.node(index)])
    }

    /// The part of a source f (in the cells) that is poured on a cell of the scheme's grid.
    pub fn source(&self, index: [usize; D], source: &[f64]) -> Source<D, f64> {
        let split =
            self.cell(index).map_or([0.0; D], |cell| self.shares[cell].map(|share| share * source[cell]));
        self.table.source(index, split)
    }

    /// A run under a source f (in the cells), from a standing layer (at the nodes) and a rolling layer (in the cells).
    ///
    /// # Errors
    /// [`BuildError`] where the scheme does not take the step, or the cells have no size.
    pub fn simulation(
        &self,
        scheme: HadelerKuttler,
        step: StepSize,
        source: &[f64],
        (standing, rolling): (&[f64], &[f64]),
    ) -> Result<Simulation<D, HadelerKuttler>, BuildError> {
        let initial = |index| {
            let cell = self.cell(index).filter(|_| self.table.inside(index));
            Pile { u: standing[self.node(index)], v: cell.map_or(0.0, |cell| rolling[cell]) }
        };
        let mut simulation = Simulation::new(scheme, self.grid(), step, |index| self.ground(index), initial)?;
        simulation.apply(|index, _| self.source(index, source));
        Ok(simulation)
    }

    /// The equilibrium under a source f (in the cells).
    ///
    /// # Errors
    /// [`Unsteady`] where there is none.
    pub fn equilibrium(&self, source: &[f64]) -> Result<Equilibrium<D>, Unsteady<D>> {
        direct::equilibrium(&self.table, self.size, &self.bed, source)
    }
}
