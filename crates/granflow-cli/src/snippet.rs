//! A wrong case as the user sees it: the headline, the lines it stands in with the place marked, and the help.

use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::ops::Range;

use granflow::case::CaseError;
use unicode_width::UnicodeWidthStr;

use crate::plain::plain;

/// Columns from one tab stop to the next.
const TAB: usize = 4;
/// Bytes of a line around a place that are shown before it, and in all.
const SHOWN: [usize; 2] = [60, 160];
/// A longer line of a message is cut in its middle [characters].
const LINE: usize = 600;
/// What stands at the mark.
const LABEL: &str = "here";

/// Colours of a terminal, or none.
#[derive(Debug, Clone, Copy)]
pub struct Ink(bool);

impl Ink {
    /// No colour.
    #[cfg(test)]
    pub const NONE: Self = Self(false);

    /// Colours if standard error is a terminal that shows them, and the user did not ask for none.
    pub fn of_standard_error() -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        Self(io::stderr().is_terminal() && !dumb && !refused)
    }

    /// The text with a code of ECMA-48, "Select graphic rendition".
    fn paint(self, code: &str, text: impl std::fmt::Display) -> String {
        if self.0 { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_string() }
    }

    fn error(self, text: &str) -> String {
        self.paint("31", text)
    }

    fn name(self, text: &str) -> String {
        self.paint("36;1;4", text)
    }

    fn number(self, text: &str) -> String {
        self.paint("2", text)
    }

    fn mark(self, text: &str) -> String {
        self.paint("35;1", text)
    }

    fn help(self, text: &str) -> String {
        self.paint("36", text)
    }
}

/// The whole message, with an empty line behind it.
pub fn shown(error: &CaseError, ink: Ink) -> String {
    let mut out = indented(&plain(&error.headline()), &format!("  {} ", ink.error("×")), &ink.error("  │ "));
    if let (Some(span), Some((line, column))) = (error.span(), error.line_column()) {
        let place = format!("{}:{line}:{column}", error.source_name());
        out += &Snippet::new(error.text(), span).drawn(&plain(&place), ink);
    }
    if !error.help_lines().is_empty() {
        out += &indented(&plain(&error.help_lines().join("\n")), &ink.help("  help: "), "        ");
    }
    out + "\n"
}

/// The lines of a text, the first behind `first` and the others behind `rest`.
fn indented(text: &str, first: &str, rest: &str) -> String {
    let lead = std::iter::once(first).chain(std::iter::repeat(rest));
    text.lines().zip(lead).map(|(line, lead)| format!("{lead}{}\n", cut(line.trim_end()))).collect()
}

/// A line of a message; of one without end its begin and its end.
fn cut(line: &str) -> String {
    let length = line.chars().count();
    if length <= LINE {
        return line.to_owned();
    }
    let (begin, end): (String, String) =
        (line.chars().take(LINE / 2).collect(), line.chars().skip(length - LINE / 4).collect());
    format!("{begin} ... {end}")
}

/// The text, [`plain`], with its tabs as spaces.
fn untabbed(text: &str) -> String {
    let mut out = String::new();
    for (k, part) in text.split('\t').enumerate() {
        if k > 0 {
            out += &" ".repeat(TAB - out.width() % TAB);
        }
        out += &plain(part);
    }
    out
}

/// The lines around a place of a text.
struct Snippet<'a> {
    lines: Vec<&'a str>,
    /// First and last line of the place, from 0.
    first: usize,
    last: usize,
    /// Where the place begins in its first line and ends in its last, in bytes.
    bytes: Range<usize>,
}

impl<'a> Snippet<'a> {
    fn new(text: &'a str, span: Range<usize>) -> Self {
        let start = text.floor_char_boundary(span.start);
        let end = text.ceil_char_boundary(span.end.max(start));
        // a place that ends with a line's end does not reach into the next line
        let end = end - usize::from(end > start && text[..end].ends_with('\n'));
        let line = |at: usize| text[..at].matches('\n').count();
        let begin = |at: usize| text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let lines = text.split('\n').map(|line| line.trim_end_matches('\r')).collect();
        let bytes = start - begin(start)..end - begin(end);
        let mut snippet = Self { lines, first: line(start), last: line(end), bytes };
        snippet.cut();
        snippet
    }

    /// Of lines without end keep what is around the place.
    fn cut(&mut self) {
        let [before, all] = SHOWN;
        let marked = self.first;
        let start = if self.first == self.last { self.bytes.start.saturating_sub(before) } else { 0 };
        let shown = self.first.saturating_sub(1)..(self.last + 2).min(self.lines.len());
        for k in shown.filter(|k| self.lines[*k].len() > 2 * all).collect::<Vec<_>>() {
            let line = self.lines[k];
            let from = line.floor_char_boundary(if k == marked { start } else { 0 });
            self.lines[k] = &line[from..line.floor_char_boundary(from + all)];
            if k == marked {
                let within = |byte: usize| byte.saturating_sub(from).min(self.lines[k].len());
                self.bytes = within(self.bytes.start)..within(self.bytes.end);
            }
        }
    }

    /// The frame with the lines of the place, one more on both sides, and the mark.
    fn drawn(&self, place: &str, ink: Ink) -> String {
        let Self { lines, first, last, .. } = self;
        let after = (last + 1 < lines.len() && lines[last + 1..] != [""]).then_some(last + 1);
        let shown = first.saturating_sub(1)..=after.unwrap_or(*last);
        let digits = (shown.end() + 1).to_string().len();
        let margin = " ".repeat(digits + 2);
        let mut out = format!("{margin}╭─[{}]\n", ink.name(place));
        for k in shown {
            let number = ink.number(&format!("{:>digits$}", k + 1));
            let _ = writeln!(out, " {number} │ {}{}", self.arrow(k, ink), untabbed(lines[k]));
            if k == *last {
                self.mark(ink).iter().for_each(|mark| out += &format!("{margin}· {mark}\n"));
            }
        }
        out + &margin + "╰────\n"
    }

    /// What joins the lines of a place of several lines, before line `k`.
    fn arrow(&self, k: usize, ink: Ink) -> String {
        let join = match k {
            _ if self.first == self.last => return String::new(),
            _ if k == self.first => "╭─▶ ",
            _ if k == self.last => "├─▶ ",
            _ if (self.first..self.last).contains(&k) => "│   ",
            _ => "    ",
        };
        ink.mark(join)
    }

    /// The lines below the place's last line.
    fn mark(&self, ink: Ink) -> Vec<String> {
        if self.first != self.last {
            return vec![format!("{} {}", ink.mark("╰────"), ink.mark(LABEL))];
        }
        let line = self.lines[self.first];
        let column = |byte: usize| untabbed(&line[..byte.min(line.len())]).width();
        let (start, end) = (column(self.bytes.start), column(self.bytes.end));
        let (length, middle) = (end - start, (end - start) / 2);
        let under = match length {
            0 => "▲".to_owned(),
            _ => format!("{}┬{}", "─".repeat(middle), "─".repeat(length - 1 - middle)),
        };
        let [to_mark, to_label] = [start, start + middle].map(|columns| " ".repeat(columns));
        vec![
            format!("{to_mark}{}", ink.mark(&under)),
            format!("{to_label}{} {}", ink.mark("╰──"), ink.mark(LABEL)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(text: &str, part: &str) -> String {
        let start = text.find(part).expect("the text holds the part");
        Snippet::new(text, start..start + part.len()).drawn("a.toml:1:1", Ink::NONE)
    }

    #[test]
    fn the_place_is_marked_with_a_line_on_both_sides() {
        let text = "[grid]\nboundry = \"open\"\n\n[time]\n";
        let expected = "   ╭─[a.toml:1:1]\n 1 │ [grid]\n 2 │ boundry = \"open\"\n   · ───┬───\n   ·    ╰── here\n \
                        3 │ \n   ╰────\n";
        assert_eq!(drawn(text, "boundry"), expected);
        let last = "   ╭─[a.toml:1:1]\n 3 │ \n 4 │ [time]\n   · ───┬──\n   ·    ╰── here\n   ╰────\n";
        assert_eq!(drawn(text, "[time]"), last);
    }

    #[test]
    fn columns_count_wide_letters_and_tabs() {
        assert!(drawn("a\t=\t\"ö漢字\"", "\"ö漢字\"").contains("   ·         ───┬───\n"));
        assert!(drawn("ö漢 = 3\r\n", "3").contains("1 │ ö漢 = 3\n   ·       ┬\n   ·       ╰── here\n"));
    }

    #[test]
    fn several_lines_are_joined() {
        let expected = "    ╭─[a.toml:1:1]\n  8 │     a\n  9 │ ╭─▶ b = [\n 10 │ │   1\n 11 │ ├─▶ ]\n    · ╰──── here\n \
                        12 │     c\n    ╰────\n";
        assert_eq!(drawn("\n\n\n\n\n\n\na\nb = [\n1\n]\nc", "[\n1\n]"), expected);
    }

    #[test]
    fn a_place_behind_the_last_byte_is_marked_too() {
        let text = "steps = [";
        let behind = Snippet::new(text, 9..9).drawn("a.toml:1:10", Ink::NONE);
        assert_eq!(
            behind,
            "   ╭─[a.toml:1:10]\n 1 │ steps = [\n   ·          ▲\n   ·          ╰── here\n   ╰────\n"
        );
    }

    #[test]
    fn of_a_line_without_end_the_place_is_shown() {
        let text = format!("a = \"{}\" + {}\n", "x".repeat(9000), "y".repeat(9000));
        let shown = drawn(&text, "+");
        assert!(shown.len() < 1000 && shown.contains("x\" + yyy") && shown.contains("·"), "{shown}");
        let marked = shown.lines().nth(2).unwrap();
        assert_eq!(
            marked.chars().position(|sign| sign == '┬'),
            shown.lines().nth(1).unwrap().chars().position(|sign| sign == '+')
        );
        assert!(drawn(&text, &text[4..9500]).len() < 1500);
        assert!(indented(&"z".repeat(9000), "", "").len() < 700);
    }

    #[test]
    fn a_message_of_several_lines_stays_together() {
        assert_eq!(indented("a\n\nb ", "  × ", "  │ "), "  × a\n  │ \n  │ b\n");
    }
}
