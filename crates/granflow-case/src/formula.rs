//! Formulas in x and y, as a case file writes them.
//!
//! The rules are those of a textbook: `^` binds tighter than the minus sign in front (`-x^2` is `-(x^2)`) and groups
//! to the right, `*` and `/` come before `+` and `-`, comparisons come last and give 1 or 0. Names are those of C
//! and NumPy. An error knows the byte at which it stands.

use reader::Reader;

mod reader;

type One = fn(f64) -> f64;
type Two = fn(f64, f64) -> f64;

/// How long a formula may be in bytes; its tree is never deeper.
const LONGEST: usize = 10_000;

/// A formula that was read and can be evaluated.
#[derive(Debug, Clone)]
pub struct Formula {
    root: Node,
}

/// What is wrong in a formula, and at which byte of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FormulaError {
    /// What was found and what is allowed there.
    pub message: String,
    /// First byte of the offending part.
    pub at: usize,
    /// Length of the offending part in bytes.
    pub length: usize,
}

impl std::fmt::Display for FormulaError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for FormulaError {}

#[derive(Debug, Clone)]
enum Node {
    Number(f64),
    Variable(usize),
    Unary(One, Box<Node>),
    Binary(Two, Box<[Node; 2]>),
    Choice(Box<[Node; 3]>),
}

impl Formula {
    /// Reads a formula in the given variables, for instance `Formula::parse("max(1 - x^2, 0)", &["x", "y"])`.
    ///
    /// # Errors
    /// [`FormulaError`] with the place of the first part that cannot be understood.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, FormulaError> {
        if text.len() > LONGEST {
            let message = format!("the formula has {} bytes, at most {LONGEST} are read", text.len());
            return Err(FormulaError { message, at: 0, length: 0 });
        }
        Ok(Self { root: Reader::of(text, variables).all()? })
    }

    /// Whether the variable of this number occurs.
    #[must_use]
    pub fn uses(&self, variable: usize) -> bool {
        self.root.uses(variable)
    }

    /// The value at the given variables, in the order they were named.
    #[must_use]
    pub fn at(&self, values: &[f64]) -> f64 {
        self.root.value(values)
    }
}

impl Node {
    fn value(&self, values: &[f64]) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Variable(index) => values[*index],
            Self::Unary(apply, inner) => apply(inner.value(values)),
            Self::Binary(apply, pair) => apply(pair[0].value(values), pair[1].value(values)),
            Self::Choice(parts) => parts[if parts[0].value(values) != 0.0 { 1 } else { 2 }].value(values),
        }
    }

    fn uses(&self, variable: usize) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Variable(index) => *index == variable,
            Self::Unary(_, inner) => inner.uses(variable),
            Self::Binary(_, pair) => pair.iter().any(|part| part.uses(variable)),
            Self::Choice(parts) => parts.iter().any(|part| part.uses(variable)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, x: f64, y: f64) -> f64 {
        Formula::parse(text, &["x", "y"]).unwrap_or_else(|error| panic!("{text}: {error}")).at(&[x, y])
    }

    fn fails(text: &str) -> (usize, String) {
        let error = Formula::parse(text, &["x", "y"]).expect_err(text);
        (error.at, error.message)
    }

    #[test]
    fn reads_as_a_textbook_does() {
        assert_eq!(value("-x^2", 3.0, 0.0), -9.0);
        assert_eq!(value("2^-1 + 2^3^2", 0.0, 0.0), 512.5);
        assert_eq!(value("1 - 2 - 3", 0.0, 0.0), -4.0);
        assert_eq!(value("8/4/2*3", 0.0, 0.0), 3.0);
        assert_eq!(value("1e-3*2E+2 + .5", 0.0, 0.0), 0.7);
        assert_eq!(value("max(1, x, y)", 2.0, 7.0), 7.0);
        assert_eq!(value("if(x > 0.6, y, -y)", 1.0, 5.0), 5.0);
        assert_eq!(value("where(x <= y, 1, 2)", 1.0, 0.0), 2.0);
        assert_eq!(value("exp(-(x-1)^2)", 3.0, 0.0), (-4.0f64).exp());
        assert_eq!(value("--x + 2*-3 + pi - π", 1.0, 0.0), -5.0);
        let sine = "max(0.9*sin(pi*(x-0.6)) - 0.3*sin(2*pi*(x-0.6)), 0.1)";
        assert!((value(sine, 1.1, 0.0) - 0.9).abs() < 1e-15);
    }

    #[test]
    fn names_the_place() {
        assert_eq!(fails("1 + sni(x)").0, 4);
        assert!(fails("1 + sni(x)").1.contains("did you mean `sin`"));
        assert_eq!(fails("max(x, 1").0, 8);
        assert_eq!(fails("x y").0, 2);
        assert_eq!(fails("2 * ").0, 3 + 1);
        assert!(fails("min(x)").1.contains("1 argument"));
        assert!(fails("1.2.3").1.contains("not a number"));
        assert_eq!(fails("").0, 0);
        assert!(fails(&"(".repeat(9_000)).1.contains("nested"));
        assert!(fails(&format!("x{}", "^x".repeat(4_000))).1.contains("powers"));
        assert!(fails(&"x+".repeat(100_000)).1.contains("bytes"));
        assert_eq!(value(&format!("x{}", "+x".repeat(4_999)), 1.0, 0.0), 5000.0);
    }
}
