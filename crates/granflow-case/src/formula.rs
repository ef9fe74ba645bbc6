//! Formulas in x and y, as a case file writes them.
//!
//! The rules are those of a textbook: `^` binds tighter than the minus sign in front (`-x^2` is `-(x^2)`) and groups
//! to the right, `*` and `/` come before `+` and `-`, comparisons come last and give 1 or 0. Names are those of C
//! and NumPy. An error knows the byte at which it stands.

type One = fn(f64) -> f64;
type Two = fn(f64, f64) -> f64;

/// Functions of one number.
const UNARY: &[(&str, One)] = &[
    ("abs", f64::abs),
    ("acos", f64::acos),
    ("asin", f64::asin),
    ("atan", f64::atan),
    ("ceil", f64::ceil),
    ("cos", f64::cos),
    ("cosh", f64::cosh),
    ("exp", f64::exp),
    ("floor", f64::floor),
    ("ln", f64::ln),
    ("log", f64::ln),
    ("log10", f64::log10),
    ("sign", |v| if v == 0.0 { 0.0 } else { v.signum() }),
    ("sin", f64::sin),
    ("sinh", f64::sinh),
    ("sqrt", f64::sqrt),
    ("tan", f64::tan),
    ("tanh", f64::tanh),
];

/// Functions of two numbers; `min` and `max` take more.
const BINARY: &[(&str, Two)] =
    &[("atan2", f64::atan2), ("hypot", f64::hypot), ("max", f64::max), ("min", f64::min)];

/// Names of the choice `if(condition, then, otherwise)`.
const CHOICE: &[&str] = &["if", "where"];

/// Comparisons, the longer ones first.
const COMPARE: &[(&str, Two)] = &[
    ("<=", |a, b| f64::from(a <= b)),
    (">=", |a, b| f64::from(a >= b)),
    ("==", |a, b| f64::from(a == b)),
    ("!=", |a, b| f64::from(a != b)),
    ("<", |a, b| f64::from(a < b)),
    (">", |a, b| f64::from(a > b)),
];

/// How long a formula may be in bytes; its tree is never deeper.
const LONGEST: usize = 10_000;
/// How deep parentheses, signs and powers may nest.
const DEEPEST: usize = 200;

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
        let mut reader = Reader { text, at: 0, depth: 0, variables };
        let root = reader.comparison()?;
        reader.skip_space();
        if reader.at < text.len() {
            return Err(reader.unexpected("an operator (+ - * / ^ < <= > >= == !=) or the end"));
        }
        Ok(Self { root })
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

struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    variables: &'a [&'a str],
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_space(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    fn take(&mut self, sign: &str) -> bool {
        self.skip_space();
        let found = self.rest().starts_with(sign);
        if found {
            self.at += sign.len();
        }
        found
    }

    fn unexpected(&mut self, wanted: &str) -> FormulaError {
        self.skip_space();
        let (found, length) = match self.rest().chars().next() {
            None => ("the formula ends here".to_owned(), 0),
            Some(sign) => (format!("found `{sign}`"), sign.len_utf8()),
        };
        FormulaError { message: format!("{found}, expected {wanted}"), at: self.at, length }
    }

    /// `sum [ < sum ]`
    fn comparison(&mut self) -> Result<Node, FormulaError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("nested more than {DEEPEST} deep");
            return Err(FormulaError { message, at: self.at, length: 1 });
        }
        let mut left = self.sum()?;
        while let Some((_, apply)) = COMPARE.iter().find(|(sign, _)| self.take(sign)) {
            left = Node::Binary(*apply, Box::new([left, self.sum()?]));
        }
        self.depth -= 1;
        Ok(left)
    }

    fn sum(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.product()?;
        loop {
            let apply: Two = if self.take("+") {
                |a, b| a + b
            } else if self.take("-") {
                |a, b| a - b
            } else {
                return Ok(left);
            };
            left = Node::Binary(apply, Box::new([left, self.product()?]));
        }
    }

    fn product(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.signed()?;
        loop {
            let apply: Two = if self.take("*") {
                |a, b| a * b
            } else if self.take("/") {
                |a, b| a / b
            } else {
                return Ok(left);
            };
            left = Node::Binary(apply, Box::new([left, self.signed()?]));
        }
    }

    /// `-power`, so that -x^2 = -(x^2)
    fn signed(&mut self) -> Result<Node, FormulaError> {
        let mut negative = false;
        loop {
            if self.take("-") {
                negative = !negative;
            } else if !self.take("+") {
                break;
            }
        }
        let value = self.power()?;
        Ok(if negative { Node::Unary(|v| -v, Box::new(value)) } else { value })
    }

    /// `atom ^ signed`, grouped to the right
    fn power(&mut self) -> Result<Node, FormulaError> {
        let base = self.atom()?;
        if !(self.take("**") || self.take("^")) {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.unexpected("fewer powers of powers"));
        }
        let exponent = self.signed()?;
        self.depth -= 1;
        // a small whole power is a product: exact where the product is, and the same on every machine
        let apply: Two = |a, b| {
            if b == 2.0 {
                a * a
            } else if b.fract() == 0.0 && b.abs() < 1e9 {
                a.powi(b as i32)
            } else {
                a.powf(b)
            }
        };
        Ok(Node::Binary(apply, Box::new([base, exponent])))
    }

    fn atom(&mut self) -> Result<Node, FormulaError> {
        self.skip_space();
        let rest = self.rest();
        match rest.chars().next() {
            Some('(') => {
                self.at += 1;
                let inner = self.comparison()?;
                if self.take(")") { Ok(inner) } else { Err(self.unexpected("`)` or an operator")) }
            }
            Some(sign) if sign.is_ascii_digit() || sign == '.' => self.number(),
            Some(sign) if sign.is_alphabetic() || sign == '_' => self.name(),
            _ => Err(self.unexpected("a number, a name or `(`")),
        }
    }

    fn number(&mut self) -> Result<Node, FormulaError> {
        let rest = self.rest().as_bytes();
        let mut length = 0;
        while length < rest.len() {
            let sign = rest[length];
            let exponent_sign = matches!(sign, b'+' | b'-') && matches!(rest[length - 1], b'e' | b'E');
            let exponent = matches!(sign, b'e' | b'E')
                && rest[length + 1..]
                    .first()
                    .is_some_and(|next| next.is_ascii_digit() || matches!(next, b'+' | b'-'));
            if !(sign.is_ascii_digit() || sign == b'.' || exponent || (length > 0 && exponent_sign)) {
                break;
            }
            length += 1;
        }
        let text = &self.rest()[..length];
        let value = text.parse().map_err(|_| FormulaError {
            message: format!("`{text}` is not a number"),
            at: self.at,
            length,
        })?;
        self.at += length;
        Ok(Node::Number(value))
    }

    fn name(&mut self) -> Result<Node, FormulaError> {
        let rest = self.rest();
        let length = rest.find(|sign: char| !(sign.is_alphanumeric() || sign == '_')).unwrap_or(rest.len());
        let (start, name) = (self.at, &rest[..length]);
        self.at += length;
        if let Some(index) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(Node::Variable(index));
        }
        match name {
            "pi" | "PI" | "π" => return Ok(Node::Number(std::f64::consts::PI)),
            "e" => return Ok(Node::Number(std::f64::consts::E)),
            _ => {}
        }
        if let Some((_, apply)) = UNARY.iter().find(|(known, _)| *known == name) {
            let [inner] = self.exactly(name, start)?;
            return Ok(Node::Unary(*apply, Box::new(inner)));
        }
        if CHOICE.contains(&name) {
            return Ok(Node::Choice(Box::new(self.exactly(name, start)?)));
        }
        let Some((_, apply)) = BINARY.iter().find(|(known, _)| *known == name) else {
            return Err(self.unknown(name, start));
        };
        let mut arguments = self.arguments()?;
        let enough = if matches!(name, "max" | "min") { arguments.len() >= 2 } else { arguments.len() == 2 };
        if !enough {
            return Err(wrong_count(name, start, arguments.len(), "2"));
        }
        let first = arguments.remove(0);
        let fold = |left, right| Node::Binary(*apply, Box::new([left, right]));
        Ok(arguments.into_iter().fold(first, fold))
    }

    fn exactly<const N: usize>(&mut self, name: &str, start: usize) -> Result<[Node; N], FormulaError> {
        let arguments = self.arguments()?;
        let count = arguments.len();
        arguments.try_into().map_err(|_| wrong_count(name, start, count, &N.to_string()))
    }

    fn arguments(&mut self) -> Result<Vec<Node>, FormulaError> {
        if !self.take("(") {
            return Err(self.unexpected("`(` with the function's arguments"));
        }
        let mut list = vec![self.comparison()?];
        while self.take(",") {
            list.push(self.comparison()?);
        }
        if self.take(")") { Ok(list) } else { Err(self.unexpected("`,`, `)` or an operator")) }
    }

    fn unknown(&self, name: &str, at: usize) -> FormulaError {
        let functions = UNARY.iter().map(|(known, _)| *known).chain(BINARY.iter().map(|(known, _)| *known));
        let known: Vec<&str> = self
            .variables
            .iter()
            .copied()
            .chain(["pi", "e"])
            .chain(functions)
            .chain(CHOICE.iter().copied())
            .collect();
        let near = super::fault::nearest(name, known.iter().copied())
            .map(|near| format!(" (did you mean `{near}`?)"))
            .unwrap_or_default();
        let message = format!("unknown name `{name}`{near}; known are {}", known.join(", "));
        FormulaError { message, at, length: name.len() }
    }
}

fn wrong_count(name: &str, at: usize, found: usize, wanted: &str) -> FormulaError {
    let message = format!("`{name}` has {found} argument(s), expected {wanted}");
    FormulaError { message, at, length: name.len() }
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
