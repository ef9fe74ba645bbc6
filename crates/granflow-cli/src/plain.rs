//! Text of others on a terminal: what would steer it is shown, not sent.

use std::borrow::Cow;

/// The text with its control characters, but for new lines and tabs, and the marks that turn the direction of writing as escapes,
/// `\u{1b}` for instance: a title or a file name can neither colour, erase nor reorder what is around it.
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for sign in text.chars() {
        if steers(sign) { out.extend(sign.escape_unicode()) } else { out.push(sign) }
    }
    Cow::Owned(out)
}

/// New lines and tabs are what lines are made of.
fn steers(sign: char) -> bool {
    !matches!(sign, '\n' | '\t') && granflow::case::steers(sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_shown() {
        assert_eq!(plain("Föhn\t漢\n"), "Föhn\t漢\n");
        assert_eq!(plain("\x1b[31mred\x07\r"), "\\u{1b}[31mred\\u{7}\\u{d}");
        assert_eq!(plain("a\u{9b}2J\u{202e}b\x7f"), "a\\u{9b}2J\\u{202e}b\\u{7f}");
    }
}
