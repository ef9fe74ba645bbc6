//! Text and numbers of others as a reader takes them.

use std::borrow::Cow;

/// A number of more signs is written with an exponent.
const LONGEST: usize = 24;

/// Whether a sign steers what shows it and is not read: control characters (C0, DEL, C1), and the directional marks of UAX 9.
#[must_use]
pub fn steers(sign: char) -> bool {
    let turns = matches!(sign, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || sign.is_control()
}

/// A title as one line: new lines and tabs are blanks, other signs that steer are written as escapes, `\u{1b}` for instance.
pub(crate) fn one_line(title: &str) -> String {
    let mut out = String::with_capacity(title.len());
    for sign in title.chars() {
        match sign {
            '\n' | '\r' | '\t' if out.ends_with(' ') => {}
            '\n' | '\r' | '\t' => out.push(' '),
            sign if steers(sign) => out.extend(sign.escape_unicode()),
            sign => out.push(sign),
        }
    }
    out.trim().to_owned()
}

/// The text with numbers of more than 24 signs in scientific form: 1e308 in place of its 309 digits.
#[must_use]
pub fn short_numbers(text: &str) -> Cow<'_, str> {
    let numeric = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    let mut rest = text;
    let mut out = String::new();
    while let Some(start) = rest.bytes().position(|byte| byte.is_ascii_digit()) {
        let length = rest.as_bytes()[start..].iter().take_while(|byte| numeric(byte)).count();
        let (before, after) = rest.split_at(start + length);
        let number = &before[start..];
        // A sentence may end behind it.
        let digits = number.trim_end_matches('.');
        match digits.parse::<f64>() {
            Ok(value) if digits.len() > LONGEST && value.is_finite() => {
                out += &before[..start];
                out += &format!("{value:e}{}", &number[digits.len()..]);
            }
            _ => out += before,
        }
        rest = after;
    }
    if out.len() + rest.len() == text.len() {
        return Cow::Borrowed(text);
    }
    Cow::Owned(out + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_is_one_line_that_steers_nothing() {
        assert_eq!(one_line("A silo,\n\tbroken\r\n"), "A silo, broken");
        assert_eq!(one_line("\u{1b}[31mred\0\u{202e}"), "\\u{1b}[31mred\\u{0}\\u{202e}");
        assert_eq!(one_line("Föhn 漢"), "Föhn 漢");
    }

    #[test]
    fn numbers_of_hundreds_of_digits_are_short() {
        assert_eq!(
            short_numbers(&format!("found {}, expected less than {}.", 1e308, -2.5e30)),
            "found 1e308, expected less than -2.5e30."
        );
        assert_eq!(short_numbers(&format!("({}, {})", 1e-300, 12.5)), "(1e-300, 12.5)");
        for text in ["0.1234567890123456", "version 1.2.3", "123456789012345678901234", "", "no. 7.", "1..2"]
        {
            assert!(matches!(short_numbers(text), Cow::Borrowed(same) if same == text));
        }
    }
}
