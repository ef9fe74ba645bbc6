//! Makes the site of the docs with mdBook: `site/build`.
//!
//! The pages are those of the repository, at their places. Formulas become MathML, `granflow verify`'s numbers a chapter,
//! rustdoc's pages a folder. A link that leads nowhere, in the source or in what was made, fails it.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr as _;

use anyhow::{Context, Result, bail};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;

mod chapters;
mod markdown;
mod math;
mod output;
mod pages;
mod verification;

use pages::{Page, Pages, file_of};

fn main() -> ExitCode {
    match site() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn site() -> Result<()> {
    let arguments: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [verified, api, site] = arguments.as_slice() else {
        bail!(
            "usage: granflow-site VERIFIED API SITE: folders of granflow verify, of cargo doc, and for the site"
        )
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("the repository")?;
    let api = Some(api).filter(|api| api.join("granflow/index.html").is_file());
    let verification = verification::chapter(verified)?;
    let more = BTreeMap::from([
        (chapters::VERIFICATION, verification.text),
        (chapters::LIBRARY, library(api.map(PathBuf::as_path))?),
    ]);
    let pages = pages::read(root, &more)?;

    let book = with_suffix(site, "-pages");
    write_book(root, &pages, &book)?;
    for (name, file) in &verification.pictures {
        copy(file, &book.join("docs/verification").join(name))?;
    }
    let site = make(&book, site)?;
    if let Some(api) = api {
        copy_folder(api, &site.join("api"))?;
    }
    let count = output::check(&site)?;
    println!("{count} pages, every link leads somewhere: {}", site.join("index.html").display());
    Ok(())
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// The way to rustdoc's pages, or how to get them.
fn library(api: Option<&Path>) -> Result<String> {
    let Some(api) = api else {
        return Ok(
            "\nThey are not part of this copy of the site: `cargo doc --no-deps --workspace` was not run \
                   before `site/build`.\n"
                .into(),
        );
    };
    let mut crates: Vec<String> = (fs::read_dir(api)?)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.starts_with("granflow") && api.join(name).join("index.html").is_file())
        .collect();
    crates.sort();
    // HTML, since the pages are no chapters.
    let items: String = crates
        .iter()
        .map(|name| format!("<li><a href=\"../api/{name}/index.html\">{name}</a></li>"))
        .collect();
    Ok(format!("\n<ul>{items}</ul>\n"))
}

/// Writes the pages and the list of chapters as mdBook reads them.
fn write_book(root: &Path, pages: &Pages, book: &Path) -> Result<()> {
    if book.exists() {
        fs::remove_dir_all(book).with_context(|| format!("removing {}", book.display()))?;
    }
    for (place, page) in &pages.pages {
        write(&book.join(file_of(place)), &page.text)?;
    }
    for picture in &pages.pictures {
        copy(&root.join(picture), &book.join(picture))?;
    }
    write(&book.join("SUMMARY.md"), &summary(pages)?)?;
    write(&with_suffix(book, "-style").join("site.css"), include_str!("../site.css"))
}

/// mdBook's list of chapters.
fn summary(pages: &Pages) -> Result<String> {
    let page = |place: &str| -> Result<&Page> {
        pages.pages.get(place).with_context(|| format!("there is no page {place}"))
    };
    let entry = |place: &str| -> Result<String> {
        let title = page(place)?.title.replace('[', "\\[").replace(']', "\\]");
        Ok(format!("[{title}]({})\n", file_of(place)))
    };
    let mut text = format!("# Summary\n\n{}\n", entry(chapters::FRONT)?);
    let linked: Vec<&str> = pages.linked.iter().map(String::as_str).collect();
    for (part, places) in chapters::PARTS.into_iter().chain([(chapters::LINKED, linked.as_slice())]) {
        text.push_str(&format!("# {part}\n\n"));
        for place in places {
            text.push_str(&format!("- {}", entry(place)?));
            for below in &page(place)?.below {
                text.push_str(&format!("  - {}", entry(below)?));
            }
        }
        text.push('\n');
    }
    Ok(text)
}

/// Lets mdBook make the site of a book; the folder without links in its name.
fn make(book: &Path, site: &Path) -> Result<PathBuf> {
    let mut config = Config::from_str(include_str!("../book.toml"))?;
    let absolute = std::path::absolute(book)?;
    config.book.src = absolute.clone();
    config.build.build_dir = std::path::absolute(site)?;
    MDBook::load_with_config(with_suffix(&absolute, "-style"), config)?.build()?;
    Ok(site.canonicalize()?)
}

fn write(path: &Path, text: &str) -> Result<()> {
    fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
    fs::write(path, text).with_context(|| format!("writing {}", path.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to.parent().unwrap_or(Path::new("")))?;
    fs::copy(from, to).with_context(|| format!("copying {}", from.display()))?;
    Ok(())
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from).with_context(|| format!("reading {}", from.display()))? {
        let path = entry?.path();
        let target = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() { copy_folder(&path, &target)? } else { copy(&path, &target)? }
    }
    Ok(())
}
