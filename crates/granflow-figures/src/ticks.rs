//! Round numbers on axes and how they are written.

/// The marks of an axis: places, texts, and the power of ten (0: none) taken out of the texts.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Ticks {
    pub at: Vec<f64>,
    pub labels: Vec<String>,
    pub exponent: i32,
    /// Places of the unlabelled marks between.
    pub minor: Vec<f64>,
}

/// Mantissas of the steps; 2.5 only where its labels stay short.
const MANTISSAS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];

/// The least round step that is at least `least`.
pub(super) fn round_step(least: f64) -> f64 {
    let decade = 10f64.powi(least.log10().floor() as i32);
    MANTISSAS.iter().map(|m| m * decade).find(|&s| s >= least * (1.0 - 1e-12)).unwrap_or(10.0 * decade)
}

/// The greatest of 1, 2, 5 times a power of ten that is at most `most`.
pub fn round_length(most: f64) -> f64 {
    let decade = 10f64.powi(most.log10().floor() as i32);
    [5.0, 2.0].into_iter().map(|m| m * decade).find(|&s| s <= most).unwrap_or(decade)
}

/// A number with `decimals` places, a true minus sign, and thin spaces between thousands from 10 000 on.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let plain = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = plain.split_once('.').unwrap_or((&plain, ""));
    let zero = plain.bytes().all(|b| matches!(b, b'0' | b'.'));
    let mut text = String::from(if value < 0.0 && !zero { "\u{2212}" } else { "" });
    for (k, digit) in whole.chars().enumerate() {
        if k > 0 && whole.len() > 4 && (whole.len() - k).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    if !fraction.is_empty() {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

/// A number to three significant digits or as a power of ten, for running text.
#[must_use]
pub fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !value.is_finite() {
        return number(value, 0);
    }
    let order = size.log10().floor() as i32;
    if !(-3..6).contains(&order) {
        return format!("{}·10{}", number(value / 10f64.powi(order), 1), superscript(order));
    }
    let decimals = (2 - order).max(0) as usize;
    let text = number(value, decimals);
    if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// A whole number in raised digits.
pub(super) fn superscript(number: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]);
    number.to_string().chars().map(raise).collect()
}

/// Round marks from `low` to `high`, at most `most` and at least two where the range allows; `coordinates` are written in
/// full, other very great or small numbers with a power of ten taken out.
pub(super) fn linear([low, high]: [f64; 2], most: usize, coordinates: bool) -> Ticks {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return Ticks::default();
    }
    let mut step = round_step(span / most.max(2) as f64);
    let places = |step: f64| -> Vec<f64> {
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        (0..=((last - first).max(-1.0) as i64)).map(|k| (first + k as f64) * step).collect()
    };
    let mut at = places(step);
    while at.len() > most.max(2) {
        step = round_step(step * 1.01);
        at = places(step);
    }
    let greatest = low.abs().max(high.abs());
    let mut exponent = 0;
    if !coordinates && !(1e-3..1e6).contains(&greatest) {
        exponent = (greatest.log10() / 3.0).floor() as i32 * 3;
    }
    let unit = 10f64.powi(exponent);
    let fits = |decimals: usize| {
        let grain = 10f64.powi(decimals as i32) * step / unit;
        (grain - grain.round()).abs() < 1e-6 * grain && grain.round() >= 1.0
    };
    let decimals = (0..15).find(|&d| fits(d)).unwrap_or(15);
    let labels = at.iter().map(|&v| number(v / unit, decimals)).collect();
    let mantissa = step / 10f64.powi((step.log10() + 1e-9).floor() as i32);
    let parts = if (mantissa - 2.0).abs() < 0.1 { 4.0 } else { 5.0 };
    let minor =
        places(step / parts).into_iter().filter(|v| at.iter().all(|a| (a - v).abs() > 0.01 * step)).collect();
    Ticks { at, labels, exponent, minor }
}

/// Marks of a logarithmic axis: powers of ten, with 2 and 5 between where there are fewer than two of them.
pub(super) fn logarithmic([low, high]: [f64; 2], most: usize) -> Ticks {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Ticks::default();
    }
    let decades = (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
    let inside = |v: &f64| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(v);
    let tens: Vec<i32> = decades.clone().filter(|&e| inside(&10f64.powi(e))).collect();
    let all = |digits: &[f64]| -> Vec<f64> {
        decades.clone().flat_map(|e| digits.iter().map(move |d| d * 10f64.powi(e))).filter(inside).collect()
    };
    let minor = if tens.len() > 12 { Vec::new() } else { all(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]) };
    let fine = [vec![1.0, 2.0, 3.0, 5.0], vec![1.0, 2.0, 5.0]].map(|digits| all(&digits));
    if tens.len() < 3
        && let Some(at) = fine.into_iter().find(|at| at.len() <= most.max(3))
    {
        let labels = at.iter().map(|&v| short(v)).collect();
        return Ticks { at, labels, exponent: 0, minor };
    }
    let every = tens.len().div_ceil(most.max(2)) as i32;
    let tens: Vec<i32> = tens.into_iter().filter(|e| e.rem_euclid(every) == 0).collect();
    let label = |e: &i32| format!("10{}", superscript(*e));
    Ticks {
        at: tens.iter().map(|&e| 10f64.powi(e)).collect(),
        labels: tens.iter().map(label).collect(),
        exponent: 0,
        minor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_a_reader_expects() {
        assert_eq!(number(-0.0, 1), "0.0");
        assert_eq!(number(-1.5, 1), "\u{2212}1.5");
        assert_eq!(number(4321.0, 0), "4321");
        assert_eq!(number(1_234_567.0, 0), "1\u{2009}234\u{2009}567");
        assert_eq!(superscript(-12), "⁻¹²");
        assert_eq!(short(0.0312), "0.0312");
        assert_eq!(short(1.5e-7), "1.5·10⁻⁷");
        assert_eq!(short(20.0), "20");
    }

    #[test]
    fn marks_are_round_and_inside() {
        let ticks = linear([-6.0, 6.0], 7, false);
        assert_eq!(ticks.labels, ["\u{2212}6", "\u{2212}4", "\u{2212}2", "0", "2", "4", "6"]);
        assert_eq!(linear([0.0, 1.0], 5, false).labels, ["0.00", "0.25", "0.50", "0.75", "1.00"]);
        let tiny = linear([0.0, 3e-6], 4, false);
        assert_eq!(
            (tiny.exponent, tiny.labels.as_slice()),
            (-6, &["0", "1", "2", "3"].map(String::from)[..])
        );
        let map = linear([5_200_100.0, 5_201_900.0], 4, true);
        assert_eq!(map.labels[0], "5\u{2009}200\u{2009}500");
        assert!(linear([1.0, 1.0], 5, false).at.is_empty());
        for span in [0.37, 1.0, 2.6, 7.1, 99.0, 1234.0] {
            let ticks = linear([0.1, 0.1 + span], 6, false);
            assert!((2..=6).contains(&ticks.at.len()), "{span}: {ticks:?}");
            assert!(ticks.at.iter().all(|v| (0.1 - 1e-9..=0.1 + span + 1e-9).contains(v)));
        }
    }

    #[test]
    fn logarithmic_marks_are_powers_of_ten() {
        assert_eq!(logarithmic([1e-4, 1.0], 8).labels, ["10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(logarithmic([0.012, 0.08], 8).labels, ["0.02", "0.03", "0.05"]);
        assert!(logarithmic([-1.0, 1.0], 8).at.is_empty());
    }
}
