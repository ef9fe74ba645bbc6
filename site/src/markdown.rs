//! One page of Markdown: its links, its anchors, its title, and its text as mdBook takes it.

use std::collections::HashMap;
use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, Event, LinkType, Options, Parser, Tag, TagEnd};

use crate::math;

/// A text in another's place.
type Edit = (Range<usize>, String);

fn events(text: &str) -> impl Iterator<Item = (Event<'_>, Range<usize>)> {
    let options = Options::ENABLE_TABLES
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_GFM
        | Options::ENABLE_MATH;
    Parser::new_ext(text, options).into_offset_iter()
}

/// The line of a place in a text, from 1.
fn line(text: &str, place: usize) -> usize {
    text[..place].matches('\n').count() + 1
}

/// The page with formulas as MathML, and every link and picture as `resolve` answers its address.
/// Faults are said with their line.
pub fn rewrite(
    text: &str,
    mut resolve: impl FnMut(&str) -> Result<String, String>,
) -> Result<String, Vec<String>> {
    let mut edits: Vec<Edit> = Vec::new();
    let mut faults = Vec::new();
    let mut formula: Option<Range<usize>> = None;
    for (event, range) in events(text) {
        let edit = match event {
            Event::InlineMath(tex) | Event::DisplayMath(tex) => {
                math::inline(&tex).map(|html| (range.clone(), html))
            }
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(language))) if &*language == "math" => {
                formula = Some(range);
                continue;
            }
            Event::Text(tex) if formula.is_some() => {
                let block = formula.take().unwrap_or_default();
                math::block(&tex).map(|html| (block, html))
            }
            Event::Start(Tag::Link { link_type, dest_url, .. } | Tag::Image { link_type, dest_url, .. })
                if !is_remote(&dest_url) =>
            {
                resolve(&dest_url).and_then(|to| link(text, range.clone(), link_type, &dest_url, to))
            }
            _ => continue,
        };
        match edit {
            Ok(edit) => edits.push(edit),
            Err(fault) => faults.push(format!("{}: {fault}", line(text, range.start))),
        }
    }
    if faults.is_empty() { Ok(edited(text, edits)) } else { Err(faults) }
}

/// Whether an address leads out of the repository.
pub fn is_remote(address: &str) -> bool {
    ["http://", "https://", "mailto:"].iter().any(|scheme| address.starts_with(scheme))
}

/// The edit that gives a link the address `to`.
fn link(text: &str, range: Range<usize>, kind: LinkType, from: &str, to: String) -> Result<Edit, String> {
    let source = &text[range.clone()];
    match (kind, source.rfind(from)) {
        (LinkType::Inline, Some(at)) => {
            let start = range.start + at;
            Ok((start..start + from.len(), to))
        }
        _ => Err(format!("the link to {from} is not written inline: [text]({from})")),
    }
}

fn edited(text: &str, mut edits: Vec<Edit>) -> String {
    // A picture inside a link is an edit before the one of the link around it.
    edits.sort_by_key(|(range, _)| range.start);
    let mut done = 0;
    let mut new = String::with_capacity(text.len());
    for (range, replacement) in edits {
        new.push_str(&text[done..range.start]);
        new.push_str(&replacement);
        done = range.end;
    }
    new + &text[done..]
}

/// The headings of a page, as plain text.
fn headings(text: &str) -> Vec<String> {
    let mut all = Vec::new();
    let mut heading: Option<String> = None;
    for (event, _) in events(text) {
        match event {
            Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
            Event::End(TagEnd::Heading(_)) => all.extend(heading.take()),
            Event::Text(part) | Event::Code(part) | Event::InlineMath(part) => {
                if let Some(heading) = &mut heading {
                    heading.push_str(&part);
                }
            }
            _ => {}
        }
    }
    all
}

/// The first heading.
pub fn title(text: &str) -> Option<String> {
    headings(text).into_iter().next()
}

/// The anchors of the headings as forges name them: letters, digits, `-` and `_`, blanks as `-`, repeated ones numbered.
pub fn anchors(text: &str) -> Vec<String> {
    let mut seen: HashMap<String, usize> = HashMap::new();
    headings(text)
        .into_iter()
        .map(|heading| {
            let anchor: String = (heading.trim().chars())
                .flat_map(char::to_lowercase)
                .filter_map(|letter| match letter {
                    ' ' => Some('-'),
                    '-' | '_' => Some(letter),
                    _ => letter.is_alphanumeric().then_some(letter),
                })
                .collect();
            let before = seen.entry(anchor.clone()).or_default();
            *before += 1;
            if *before == 1 { anchor } else { format!("{anchor}-{}", *before - 1) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_get_new_addresses_and_nothing_else_changes() {
        let text = "# A\n\n[![p](p.png)](b.md#c) and `[no](x.md)` [far](https://e.org) [b](b.md)\n";
        let new = rewrite(text, |address| Ok(format!("new/{address}"))).unwrap();
        let expected =
            "# A\n\n[![p](new/p.png)](new/b.md#c) and `[no](x.md)` [far](https://e.org) [b](new/b.md)\n";
        assert_eq!(new, expected);
    }

    #[test]
    fn faults_have_their_line() {
        let faults = rewrite("a\n\n[b](gone.md)\n\n```math\n\\frac{1\n```\n", |_| Err("gone".into()));
        let faults = faults.unwrap_err();
        assert_eq!(faults[0], "3: gone");
        assert!(faults.len() == 2 && faults[1].starts_with("6: "), "{faults:?}");
        assert!(rewrite("[b][c]\n\n[c]: d.md\n", |address| Ok(address.into())).is_err());
    }

    #[test]
    fn formulas_become_mathml() {
        let new = rewrite("x $a_1$ y\n\n```math\nb\n```\n\nz\n", |_| unreachable!()).unwrap();
        assert!(new.starts_with("x <math>") && new.contains("</math> y\n\n<div class=\"formula\">"), "{new}");
        assert!(new.ends_with("</div>\n\n\nz\n"), "{new}");
    }

    #[test]
    fn anchors_are_those_of_forges() {
        let text = "# A & b\n## Sandpiles: `model = \"hadeler_kuttler\"`\n## Same\n## Same\n## µ, Θ\n";
        let expected = ["a--b", "sandpiles-model--hadeler_kuttler", "same", "same-1", "µ-θ"];
        assert_eq!(anchors(text), expected);
    }
}
