//! Formulas: TeX to MathML, which browsers draw without fonts or scripts of ours.

use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};

/// A formula in the running text, as inline HTML of Markdown.
///
/// # Errors
/// What the formula has wrong.
pub fn inline(tex: &str) -> Result<String, String> {
    Ok(escape_text(&mathml(tex, MathDisplay::Inline)?))
}

/// A formula on its own, as a block of HTML. Lines of TeX that `\\` ends are lines of the formula.
///
/// # Errors
/// What the formula has wrong.
pub fn block(tex: &str) -> Result<String, String> {
    Ok(format!("<div class=\"formula\">{}</div>\n", mathml(tex, MathDisplay::Block)?))
}

fn mathml(tex: &str, display: MathDisplay) -> Result<String, String> {
    let converter = LatexToMathML::new(MathCoreConfig::default()).map_err(|(error, ..)| error.to_string())?;
    let converted =
        converter.convert_with_local_state(tex.trim(), display).map_err(|error| error.to_string())?;
    Ok(converted.mathml.replace('\n', " "))
}

/// Between the tags, punctuation that Markdown would take for itself becomes references to characters.
fn escape_text(html: &str) -> String {
    let mut inside_tag = false;
    let mut escaped = String::with_capacity(html.len());
    for letter in html.chars() {
        inside_tag = (inside_tag || letter == '<') && letter != '>';
        if inside_tag || !"*_\\[]`|~#!".contains(letter) {
            escaped.push(letter);
        } else {
            escaped.push_str(&format!("&#{};", u32::from(letter)));
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_formula_is_markdown() {
        let html = inline("a_1^* |b| [c] \\backslash").unwrap();
        assert!(html.starts_with("<math>") && html.contains("<msubsup>"), "{html}");
        assert!(!html.contains('|') && !html.contains(['*', '[', '\\']), "{html}");
    }

    #[test]
    fn a_wrong_formula_is_refused() {
        assert!(inline("\\nonsense x").is_err() && block("\\frac{1").is_err());
    }
}
