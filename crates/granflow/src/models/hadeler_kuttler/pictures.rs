//! What is drawn of a sandpile.

use super::figures;
use super::table::TableDomain;
use crate::model::{Domain, Drawing, Instants, Pictures, ResultFile, Scene, View};
use crate::output;
use std::sync::Arc;

const LAYERS: &[&str] = &["standing_layer", "rolling_layer"];

#[derive(Debug)]
pub(super) struct Sandpile;

impl Pictures for Sandpile {
    fn needed(&self) -> &'static [&'static str] {
        &["time", "x", "x_node", "standing_layer", "rolling_layer"]
    }

    /// The table in the file; its cells are those where the rolling layer has a value.
    fn domain(&self, file: &ResultFile, [x, y]: [&[f64]; 2]) -> Result<Arc<dyn Domain>, String> {
        let faces =
            |name: &str| Ok::<_, String>(file.optional(name)?.iter().map(|&wall| wall > 0.0).collect());
        let rolling = file.first("rolling_layer", if y.is_empty() { 1 } else { 2 })?;
        let table = TableDomain {
            x_node: file.whole("x_node")?,
            y_node: file.optional("y_node")?,
            inside: rolling.iter().map(|v| !v.is_nan()).collect(),
            height: file.optional("table_height")?,
            wall_x: faces("wall_x")?,
            wall_y: faces("wall_y")?,
        };
        if !table.fits(x, y) {
            return Err("its cells do not fit its nodes".to_owned());
        }
        Ok(Arc::new(table))
    }

    fn shown(&self, _domain: &dyn Domain, _dimensions: usize) -> &'static [&'static str] {
        LAYERS
    }

    fn figures<'a>(&self, view: &'a View<'a>, domain: &'a dyn Domain) -> Vec<Drawing<'a>> {
        let table = table(domain);
        if view.dimensions() == 1 { figures::line(view, table) } else { figures::plane(view, table) }
    }

    fn animated(&self) -> &'static [&'static str] {
        LAYERS
    }

    fn scene<'a>(
        &self,
        view: &'a View<'a>,
        domain: &'a dyn Domain,
        instants: &mut Instants<'_>,
    ) -> Result<Box<dyn Scene + 'a>, output::Error> {
        figures::scene(view, table(domain), instants)
    }
}

fn table(domain: &dyn Domain) -> &TableDomain {
    domain.get().expect("a sandpile grows on a table")
}
