//! The verification chapter, from the folder that `granflow verify` wrote.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;

/// A row of `tables.json`.
#[derive(Deserialize)]
struct Row {
    name: String,
    quantity: String,
    published: Option<f64>,
    exact: Option<f64>,
    independent: Option<f64>,
    computed: Option<f64>, // null where it is not finite
    tolerance: f64,
    measure: String,
    reason: Option<String>,
    pass: bool,
}

/// What the chapter ends with, and its pictures: the name in the site's folder `docs/verification` and the file.
pub struct Chapter {
    /// Markdown.
    pub text: String,
    /// By name.
    pub pictures: BTreeMap<String, std::path::PathBuf>,
}

/// Makes the chapter of the folder `verified`.
///
/// # Errors
/// If the folder is not one of `granflow verify`.
pub fn chapter(verified: &Path) -> Result<Chapter> {
    let read = |name: &str| {
        fs::read_to_string(verified.join(name)).with_context(|| {
            let folder = verified.display();
            format!("reading {folder}/{name}; `granflow verify --out {folder}` writes it")
        })
    };
    let rows: Vec<Row> = serde_json::from_str(&read("tables.json")?).context("tables.json")?;
    let page = read("index.html")?;
    let mut names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    names.dedup();
    ensure!(!names.is_empty(), "{} has no rows", verified.join("tables.json").display());
    let mut pictures = BTreeMap::new();
    let mut text = summary(&rows, &names, version(&page));
    for name in &names {
        let about = about(&page, name, verified, &mut pictures)?;
        write!(text, "\n## {name}\n\n{about}\n\n{}", table(&rows, name)?)?;
    }
    Ok(Chapter { text, pictures })
}

/// The version that the page names.
fn version(page: &str) -> &str {
    let found = page.split_once("name=\"generator\" content=\"").and_then(|(_, rest)| rest.split_once('"'));
    found.map_or("granflow", |(version, _)| version)
}

/// Rows and failures by benchmark.
fn summary(rows: &[Row], names: &[&str], version: &str) -> String {
    let failed = rows.iter().filter(|row| !row.pass).count();
    let verdict = match failed {
        0 => format!("All {} rows are within their tolerances.", rows.len()),
        _ => format!("**{failed} of {} rows are outside their tolerances.**", rows.len()),
    };
    let mut text = format!("\n## What was found\n\n{verdict} Computed by {version}.\n\n");
    text.push_str("| benchmark | rows | outside |\n| --- | ---: | ---: |\n");
    for name in names {
        let of_it = || rows.iter().filter(|row| row.name == *name);
        let failed = of_it().filter(|row| !row.pass).count();
        text.push_str(&format!("| {name} | {} | {failed} |\n", of_it().count()));
    }
    text
}

/// What the page says of a benchmark, as HTML: setup, known answer, errors on each grid, and pictures as files.
fn about(
    page: &str,
    name: &str,
    verified: &Path,
    pictures: &mut BTreeMap<String, std::path::PathBuf>,
) -> Result<String> {
    let heading = format!("<section><h2>{}</h2>", name.replace('\'', "&#39;"));
    let plain = format!("<section><h2>{name}</h2>");
    let section = (page.split_once(&heading).or_else(|| page.split_once(&plain)))
        .and_then(|(_, rest)| rest.split_once("</section>"))
        .map(|(section, _)| section)
        .with_context(|| format!("index.html has no section `{name}`"))?;
    let letter = name.split(' ').next().unwrap_or(name).to_lowercase();
    let mut files = (["curves", "errors"].iter())
        .map(|kind| format!("{letter}_{kind}.png"))
        .filter(|file| verified.join("figures").join(file).is_file());
    let mut parts = section.split("src=\"data:");
    let mut html = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let Some(file) = files.next() else { bail!("`{name}` has more pictures than figures/ has files") };
        let (_, rest) = part.split_once('"').context("index.html: a picture without an end")?;
        write!(html, "loading=\"lazy\" src=\"verification/{file}\"{rest}")?;
        pictures.insert(file.clone(), verified.join("figures").join(&file));
    }
    ensure!(!html.contains("\n\n"), "index.html: an empty line would end the block of HTML");
    Ok(format!("<div>{html}</div>"))
}

/// The rows of a benchmark. A reason stands once where it holds for several rows.
fn table(rows: &[Row], name: &str) -> Result<String> {
    let mut text = "| what | computed | must be | why |\n| --- | --- | --- | --- |\n".to_owned();
    for row in rows.iter().filter(|row| row.name == name) {
        let computed = row.computed.map_or("not finite".into(), number);
        let mark = if row.pass { "" } else { " **outside**" };
        let why = row.reason.as_deref().unwrap_or_default();
        writeln!(text, "| {} | {computed}{mark} | {} | {} |", cell(&row.quantity), bound(row)?, cell(why))?;
    }
    Ok(text)
}

/// Text that stays what it is in a cell of a table.
fn cell(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        if "|*_<[`$\\".contains(letter) {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}

fn bound(row: &Row) -> Result<String> {
    let expected =
        row.published.or(row.exact).or(row.independent).context("tables.json: a row expects nothing")?;
    Ok(match row.measure.as_str() {
        "absolute" => format!("{} ± {}", number(expected), number(row.tolerance)),
        "relative" => format!("{} ± {} %", number(expected), number(100.0 * row.tolerance)),
        "at_most" => format!("at most {}", number(expected + row.tolerance)),
        "at_least" => format!("at least {}", number(expected - row.tolerance)),
        other => bail!("tables.json: a measure `{other}`"),
    })
}

/// A number to four digits.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (3.0 - size.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: &str = r#"[
        {"name": "A Dam", "quantity": "energy_stable: L1(h)", "exact": 0.0, "computed": 0.25, "tolerance": 0.5,
         "measure": "at_most", "reason": "two cells", "pass": true},
        {"name": "A Dam", "quantity": "order", "exact": 1.0, "computed": null, "tolerance": 0.4,
         "measure": "at_least", "pass": false}]"#;
    const PAGE: &str = "<meta name=\"generator\" content=\"granflow 9.8.7\"><section><h2>A Dam</h2><p>It \
        breaks.</p><figure><img src=\"data:image/png;base64,AAAA\" alt=\"A\"></figure></section>";

    /// A folder as `granflow verify` leaves it.
    fn folder(name: &str, page: &str) -> std::path::PathBuf {
        let folder = std::env::temp_dir().join(format!("granflow-site-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("figures")).unwrap();
        fs::write(folder.join("tables.json"), ROWS).unwrap();
        fs::write(folder.join("index.html"), page).unwrap();
        fs::write(folder.join("figures/a_errors.png"), "picture").unwrap();
        folder
    }

    #[test]
    fn every_row_and_picture_is_in_the_chapter() {
        let verified = folder("whole", PAGE);
        let chapter = chapter(&verified).unwrap();
        fs::remove_dir_all(&verified).unwrap();
        for part in [
            "**1 of 2 rows are outside their tolerances.** Computed by granflow 9.8.7.",
            "| A Dam | 2 | 1 |",
            "## A Dam\n\n<div><p>It breaks.</p>",
            "src=\"verification/a_errors.png\" alt=\"A\"",
            "| energy\\_stable: L1(h) | 0.25 | at most 0.5 | two cells |",
            "| order | not finite **outside** | at least 0.6 |  |",
        ] {
            assert!(chapter.text.contains(part), "{part}\n{}", chapter.text);
        }
        assert_eq!(chapter.pictures.keys().collect::<Vec<_>>(), ["a_errors.png"]);
    }

    #[test]
    fn a_folder_of_something_else_is_refused() {
        let verified = folder("other", "<html></html>");
        let error = chapter(&verified).err().map(|error| format!("{error:#}"));
        fs::remove_dir_all(&verified).unwrap();
        assert_eq!(error.unwrap(), "index.html has no section `A Dam`");
        assert!(format!("{:#}", chapter(&verified).err().unwrap()).contains("granflow verify --out"));
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.0039446, "0.003945"),
            (-2.0, "-2"),
            (1234.56, "1235"),
            (4e-14, "4.00e-14"),
            (100.0, "100"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
