//! Error against cell size in logarithmic scales, with the slopes that orders of convergence would have.

use super::axes::{Axis, Panel, RIM, Scale, extent, heading};
use super::canvas::{Area, Canvas, Lettering, Pen};
use super::colours::GREY;
use super::curves::solid;
use super::legend::{Key, Legend, along};
use super::ticks::{number, short};
use super::{Figure, FigureError, Picture};

/// The errors of one method on finer and finer grids.
#[derive(Debug, Clone, Copy, Default)]
pub struct ErrorSeries<'a> {
    /// Its name; the legend adds the order that a least-squares line through the logarithms gives.
    pub name: &'a str,
    /// Cell sizes.
    pub sizes: &'a [f64],
    /// Errors, as many; one that is not positive cannot be drawn and is left out.
    pub errors: &'a [f64],
}

impl ErrorSeries<'_> {
    fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let good = |v: f64| v.is_finite() && v > 0.0;
        self.sizes
            .iter()
            .copied()
            .zip(self.errors.iter().copied())
            .filter(move |&(dx, e)| good(dx) && good(e))
    }

    /// The slope of the least-squares line through (ln dx, ln error); `None` below two different sizes.
    #[must_use]
    pub fn order(&self) -> Option<f64> {
        let n = self.points().count() as f64;
        let (sx, sy) = self.points().fold((0.0, 0.0), |(sx, sy), (dx, e)| (sx + dx.ln(), sy + e.ln()));
        let (mx, my) = (sx / n, sy / n);
        let (xy, xx) = self.points().fold((0.0, 0.0), |(xy, xx), (dx, e)| {
            let d = dx.ln() - mx;
            (xy + d * (e.ln() - my), xx + d * d)
        });
        (xx > 0.0).then(|| xy / xx)
    }

    fn line(&self, panel: &Panel) -> Vec<[f64; 2]> {
        let (dx, e): (Vec<f64>, Vec<f64>) = self.points().unzip();
        panel.line(&dx, &e)
    }
}

/// Errors over cell sizes, both logarithmic.
#[derive(Debug, Clone, Copy, Default)]
pub struct Convergence<'a> {
    /// The heading.
    pub title: &'a str,
    /// A second, smaller line under it.
    pub subtitle: &'a str,
    /// The cell size.
    pub size: Axis<'a>,
    /// The error.
    pub error: Axis<'a>,
    /// One series per method.
    pub series: &'a [ErrorSeries<'a>],
    /// Orders whose slopes are shown for comparison, as 0.5, 1, 2.
    pub orders: &'a [f64],
}

impl Figure for Convergence<'_> {
    fn draw(&self) -> Result<Picture, FigureError> {
        for series in self.series {
            let what = format!("errors of `{}`", series.name);
            FigureError::same_length(self.title, &what, series.errors.len(), series.sizes.len())?;
        }
        let none = || FigureError::empty(self.title, "no positive error at a positive cell size");
        let points = || self.series.iter().flat_map(ErrorSeries::points);
        let sizes = extent(points().map(|(dx, _)| dx)).ok_or_else(none)?;
        let x = Scale::logarithmic(&self.size, points().map(|(dx, _)| dx), 1.35).ok_or_else(none)?;
        let y = Scale::logarithmic(&self.error, points().map(|(_, e)| e), 2.0).ok_or_else(none)?;

        let (width, height) = (720.0, 540.0);
        let mut canvas = Canvas::new(width, height);
        let top = heading(&mut canvas, self.title, self.subtitle, width);
        let outer = Area { left: RIM, top, width: width - 2.0 * RIM, height: height - top - RIM };
        let fitted = |outer| Panel::fit(outer, x, y, self.size.caption(), self.error.caption());
        // All slopes leave one point, under the coarsest and least error, so that they fan out to the left.
        let coarsest =
            points().filter(|p| p.0 >= sizes[1] * (1.0 - 1e-9)).map(|p| p.1).fold(f64::INFINITY, f64::min);
        let slopes = Slopes { foot: (sizes[1], coarsest / 1.4), finest: sizes[0], least: y.range };

        let legend = self.legend();
        let mut panel = fitted(outer);
        let (mut place, covered) = legend.best_place(panel.area, &self.taken(&panel, &slopes));
        if covered > 2 && !legend.is_empty() {
            panel = fitted(Area { width: outer.width - legend.size()[0] - 6.0, ..outer });
            place = Area { left: panel.area.right() + 12.0, top: panel.area.top, ..place };
        }
        panel.draw_grid(&mut canvas);
        canvas.clip(Some(panel.area));
        self.orders.iter().for_each(|order| slopes.draw(&mut canvas, &panel, *order));
        for (turn, series) in self.series.iter().enumerate() {
            let (line, pen) = (series.line(&panel), solid(turn));
            canvas.line(&line, pen);
            line.iter().for_each(|&p| canvas.disc(p, 3.4, pen.colour));
        }
        canvas.clip(None);
        panel.draw_frame(&mut canvas);
        legend.draw(&mut canvas, place);
        Ok(canvas.finish())
    }
}

impl Convergence<'_> {
    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        for (turn, series) in self.series.iter().enumerate() {
            let order =
                series.order().map_or(String::new(), |order| format!(" (order {})", number(order, 2)));
            legend.add(format!("{}{order}", series.name), Key::Line(solid(turn)));
        }
        legend
    }

    /// Where lines run in a panel.
    fn taken(&self, panel: &Panel, slopes: &Slopes) -> Vec<[f64; 2]> {
        let mut taken = Vec::new();
        let of_orders = self.orders.iter().map(|order| slopes.line(panel, *order));
        let of_series = self.series.iter().map(|series| series.line(panel));
        of_orders.chain(of_series).for_each(|line| along(&line, panel.area, &mut taken));
        taken
    }
}

/// Lines of given orders for comparison, which leave one point.
struct Slopes {
    /// The point: cell size and error.
    foot: (f64, f64),
    /// The finest cell size.
    finest: f64,
    /// The errors at the foot and the head of the panel.
    least: [f64; 2],
}

impl Slopes {
    fn error(&self, order: f64, dx: f64) -> f64 {
        self.foot.1 * (dx / self.foot.0).powf(order)
    }

    fn line(&self, panel: &Panel, order: f64) -> Vec<[f64; 2]> {
        let ends = [self.finest, self.foot.0];
        panel.line(&ends, &ends.map(|dx| self.error(order, dx)))
    }

    fn draw(&self, canvas: &mut Canvas, panel: &Panel, order: f64) {
        let line = self.line(panel, order);
        canvas.line(&line, Pen { dashes: &[5.0, 4.0], ..Pen::new(GREY, 1.1) });
        // The name stands on the line, two thirds of the way to the finest grid or where the line leaves the panel.
        let lowest = self.least[0] * (self.least[1] / self.least[0]).powf(0.05);
        let leaves = if order > 0.0 { self.foot.0 * (lowest / self.foot.1).powf(1.0 / order) } else { 0.0 };
        let dx = self.foot.0 * (self.finest.max(leaves) / self.foot.0).powf(0.8);
        let angle = (line[1][1] - line[0][1]).atan2(line[1][0] - line[0][0]).to_degrees();
        let how = Lettering { colour: GREY, angle: -angle, halo: true, ..Lettering::new(11.0, [0.5, 1.35]) };
        canvas.text(&format!("order {}", short(order)), panel.place(dx, self.error(order, dx)), how);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_the_slope_of_the_logarithms() {
        let sizes = [0.1, 0.05, 0.025];
        let errors = sizes.map(|dx: f64| 3.0 * dx.powf(1.7));
        let order = ErrorSeries { name: "", sizes: &sizes, errors: &errors }.order();
        assert!((order.unwrap() - 1.7).abs() < 1e-12);
        assert!(ErrorSeries { name: "", sizes: &[0.1], errors: &[1.0] }.order().is_none());
        assert!(ErrorSeries { name: "", sizes: &[0.1, 0.1], errors: &[1.0, 0.0] }.order().is_none());
    }
}
