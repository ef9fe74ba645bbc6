//! The colours of lines and fields: evenly perceived, safe for the colour-blind.

/// A colour: red, green, blue.
pub type Rgb = [u8; 3];

pub(super) const INK: Rgb = [34, 34, 34];
pub(super) const GREY: Rgb = [110, 110, 110];
pub(super) const PALE: Rgb = [228, 228, 228];
pub(super) const WHITE: Rgb = [255, 255, 255];

/// How many line colours there are.
pub(super) const LINE_COLOURS: usize = 7;

/// The `index`-th line colour, in turn: Okabe and Ito's set, told apart by every kind of eye (the yellow is left out).
#[must_use]
pub fn line_colour(index: usize) -> Rgb {
    const LINES: [Rgb; LINE_COLOURS] = [
        [0, 114, 178],
        [213, 94, 0],
        [0, 158, 115],
        [204, 121, 167],
        [230, 159, 0],
        [86, 180, 233],
        [34, 34, 34],
    ];
    LINES[index % LINES.len()]
}

/// A scale of colours for a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Colours {
    /// Dark blue over green to yellow, evenly perceived: for fields that fill the picture.
    #[default]
    Viridis,
    /// Pale yellow over red to dark violet: for a thickness on a pale ground.
    Thickness,
    /// Pale yellow over green to dark blue: for a speed on a pale ground.
    Speed,
    /// Blue over white to red, the white at zero: for a field of both signs.
    Diverging,
    /// White to black.
    Grey,
}

impl Colours {
    /// The colour at `t`, held to 0..1 (from the least to the greatest value).
    #[must_use]
    pub fn at(self, t: f64) -> Rgb {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        let colour = match self {
            Self::Viridis => colorous::VIRIDIS.eval_continuous(t),
            Self::Thickness => colorous::INFERNO.eval_continuous(0.96 - 0.80 * t),
            Self::Speed => colorous::YELLOW_GREEN_BLUE.eval_continuous(0.12 + 0.88 * t),
            Self::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - t),
            Self::Grey => colorous::GREYS.eval_continuous(t),
        };
        [colour.r, colour.g, colour.b]
    }

    /// The scale at 1024 even steps, for painting many pixels.
    pub(super) fn table(self) -> Vec<Rgb> {
        (0..1024).map(|k| self.at(f64::from(k) / 1023.0)).collect()
    }

    /// The range of colours for values from `low` to `high`: even about zero for [`Colours::Diverging`].
    pub(super) fn range(self, [low, high]: [f64; 2]) -> [f64; 2] {
        if self != Self::Diverging {
            return [low, high];
        }
        let most = low.abs().max(high.abs());
        [-most, most]
    }
}

/// The entry of a [`Colours::table`] for `value` in `range`.
pub(super) fn pick(table: &[Rgb], value: f64, [low, high]: [f64; 2]) -> Rgb {
    let last = table.len() - 1;
    let t = (value - low) / (high - low);
    table[if t > 0.0 { ((t * last as f64 + 0.5) as usize).min(last) } else { 0 }]
}

/// The nearest of 0..255, without the call that `round` is: millions of pixels are rounded three times or more.
pub(super) fn whole(shade: f64) -> u8 {
    (shade + 0.5) as u8
}

/// `a` at 0, `b` at 1.
pub(super) fn mix(a: Rgb, b: Rgb, t: f64) -> Rgb {
    std::array::from_fn(|k| whole(f64::from(a[k]) * (1.0 - t) + f64::from(b[k]) * t))
}

/// The colour in more or less light.
pub(super) fn shade(colour: Rgb, light: f64) -> Rgb {
    std::array::from_fn(|k| whole(f64::from(colour[k]) * light))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of sRGB (IEC 61966-2-1).
    fn luminance(colour: Rgb) -> f64 {
        let linear = |c: u8| (f64::from(c) / 255.0).powf(2.2);
        0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2])
    }

    #[test]
    fn scales_are_monotone_in_lightness() {
        for (colours, sign) in [(Colours::Viridis, 1.0), (Colours::Thickness, -1.0), (Colours::Speed, -1.0)] {
            let steps: Vec<f64> = (0..=20).map(|k| luminance(colours.at(f64::from(k) / 20.0))).collect();
            assert!(steps.windows(2).all(|w| sign * (w[1] - w[0]) > 0.0), "{colours:?}: {steps:?}");
        }
    }

    #[test]
    fn the_table_hits_both_ends_and_survives_nan() {
        let table = Colours::Viridis.table();
        assert_eq!(pick(&table, -1.0, [0.0, 2.0]), Colours::Viridis.at(0.0));
        assert_eq!(pick(&table, 5.0, [0.0, 2.0]), Colours::Viridis.at(1.0));
        assert_eq!(pick(&table, f64::NAN, [0.0, 2.0]), table[0]);
        assert_eq!(Colours::Diverging.range([-1.0, 3.0]), [-3.0, 3.0]);
    }
}
