//! From the text of a formula to its tree.

use super::{FormulaError, Node, One, Two};

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

/// How deep parentheses, signs and powers may nest.
const DEEPEST: usize = 200;

pub(super) struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    variables: &'a [&'a str],
}

impl<'a> Reader<'a> {
    pub fn of(text: &'a str, variables: &'a [&'a str]) -> Self {
        Self { text, at: 0, depth: 0, variables }
    }

    /// The whole text as one formula.
    pub fn all(mut self) -> Result<Node, FormulaError> {
        let root = self.comparison()?;
        self.skip_space();
        if self.at < self.text.len() {
            return Err(self.unexpected("an operator (+ - * / ^ < <= > >= == !=) or the end"));
        }
        Ok(root)
    }

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
        let near = crate::nearest::nearest(name, known.iter().copied())
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
