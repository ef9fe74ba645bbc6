//! Names that are like a misspelt one.

/// The name that is most like `found`, if one is like it at all.
pub fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let found = found.to_lowercase();
    known
        .into_iter()
        .map(|name| {
            let lower = name.to_lowercase();
            let begins = found.len() >= 3 && lower.starts_with(&found);
            (
                if begins { 0.9 } else { 0.0f64 }.max(strsim::normalized_damerau_levenshtein(&found, &lower)),
                name,
            )
        })
        .filter(|(likeness, _)| *likeness >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_spelling() {
        let names = ["balanced", "balanced_2", "verfahren_1"];
        assert_eq!(nearest("balancd", names), Some("balanced"));
        assert_eq!(nearest("Verfahren1", names), Some("verfahren_1"));
        assert_eq!(nearest("upwind", names), None);
        assert_eq!(nearest("velo", ["velocity_x", "thickness"]), Some("velocity_x"));
    }
}
