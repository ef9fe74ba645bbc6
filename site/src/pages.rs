//! The pages of the site, found by following every link of the chapters.
//!
//! They keep their places in the repository, so that links between them stay as they are. A file that is not
//! Markdown becomes a page that shows it, a folder one that lists it.

use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::{chapters, markdown};

/// A page as mdBook takes it.
pub struct Page {
    /// Its heading.
    pub title: String,
    /// Its text.
    pub text: String,
    /// The pages below it in the list of chapters: those of a folder.
    pub below: Vec<String>,
}

/// What the site is made of.
#[derive(Default)]
pub struct Pages {
    /// By their places in the repository; folders end with `/`.
    pub pages: BTreeMap<String, Page>,
    /// Those that are in no part and below no folder.
    pub linked: Vec<String>,
    /// Pictures.
    pub pictures: Vec<String>,
}

/// The file of a page in the book.
pub fn file_of(place: &str) -> String {
    match place.strip_suffix("README.md") {
        Some(folder) => format!("{folder}index.md"),
        None if place.ends_with('/') => format!("{place}index.md"),
        None if place.ends_with(".md") => place.to_owned(),
        None => format!("{place}.md"),
    }
}

/// Reads all pages; `more` gives what a page ends with that is not in the repository.
///
/// # Errors
/// Every link that leads nowhere and every formula that is none, by file and line.
pub fn read(root: &Path, more: &BTreeMap<&str, String>) -> Result<Pages> {
    let mut found = Pages::default();
    let mut faults = Vec::new();
    let listed = chapters::PARTS.iter().flat_map(|(_, places)| places.iter());
    let mut waiting: VecDeque<String> =
        [chapters::FRONT].iter().chain(listed).map(|place| (*place).to_owned()).collect();
    let first = waiting.len();
    let mut taken = 0;
    while let Some(place) = waiting.pop_front() {
        taken += 1;
        if found.pages.contains_key(&place) {
            continue;
        }
        let below = found.pages.values().any(|page| page.below.contains(&place));
        if taken > first && !below {
            found.linked.push(place.clone());
        }
        let (source, below) = source(root, &place).with_context(|| format!("page {place}"))?;
        let source = source + more.get(place.as_str()).map_or("", String::as_str);
        waiting.extend(below.iter().cloned());
        let text = markdown::rewrite(&source, |address| {
            let target = Target::of(root, &place, address)?;
            if target.is_picture() {
                found.pictures.push(target.place.clone());
            } else {
                waiting.push_back(target.place.clone());
            }
            Ok(target.address_in_book(address))
        });
        let text = text.unwrap_or_else(|here| {
            faults.extend(here.into_iter().map(|fault| format!("{place}:{fault}")));
            String::new()
        });
        let title = markdown::title(&source).with_context(|| format!("{place} has no heading"))?;
        found.pages.insert(place, Page { title, text, below });
    }
    if !faults.is_empty() {
        bail!("{}", faults.join("\n"));
    }
    // A page that a folder lists was perhaps linked before the folder.
    let below: Vec<String> = found.pages.values().flat_map(|page| page.below.iter().cloned()).collect();
    found.linked.retain(|place| !below.contains(place));
    Ok(found)
}

/// The Markdown of a page, and what stands below it.
fn source(root: &Path, place: &str) -> Result<(String, Vec<String>)> {
    let path = root.join(place);
    if place.ends_with('/') {
        return listing(&path, place);
    }
    let text = fs::read_to_string(&path)?;
    if place.ends_with(".md") {
        return Ok((text, Vec::new()));
    }
    let language = Path::new(place).extension().and_then(|end| end.to_str()).unwrap_or("text");
    let fence = "`".repeat(3 + text.matches("```").count());
    Ok((format!("# {place}\n\n{fence}{language}\n{}\n{fence}\n", text.trim_end()), Vec::new()))
}

/// The page that lists a folder: its pages by title, other files by the comment in their first line.
fn listing(path: &Path, place: &str) -> Result<(String, Vec<String>)> {
    let mut names: Vec<String> = (fs::read_dir(path)?)
        .filter_map(|entry| entry.ok().filter(|entry| entry.path().is_file()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.'))
        .collect();
    names.sort();
    let title = Path::new(place).file_name().and_then(|name| name.to_str()).unwrap_or(place);
    let mut text = format!("# {}{}\n\n", title[..1].to_uppercase(), &title[1..]);
    for name in &names {
        let file = fs::read_to_string(path.join(name)).with_context(|| format!("reading {place}{name}"))?;
        let about = if name.ends_with(".md") {
            markdown::title(&file).unwrap_or_default()
        } else {
            file.lines().next().unwrap_or_default().trim_start_matches(['#', '/', '!', ' ']).to_owned()
        };
        text.push_str(&format!("- [{name}]({name}): {about}\n"));
    }
    Ok((text, names.into_iter().map(|name| format!("{place}{name}")).collect()))
}

/// Where a link leads.
struct Target {
    /// In the repository; a folder ends with `/`, or is its README.
    place: String,
    /// The address with which a file of the same folder would name it, and the anchor.
    was_folder: bool,
}

impl Target {
    /// What `address` means on the page `from`.
    fn of(root: &Path, from: &str, address: &str) -> Result<Self, String> {
        let (path, anchor) = address.split_once('#').map_or((address, None), |(p, a)| (p, Some(a)));
        let folder = Path::new(from).parent().unwrap_or(Path::new(""));
        let folder = if from.ends_with('/') { Path::new(from) } else { folder };
        let place = if path.is_empty() { Some(PathBuf::from(from)) } else { plain(&folder.join(path)) };
        let place = place.ok_or_else(|| format!("{path} leads out of the repository"))?;
        let on_disk = root.join(&place);
        let mut place = place.to_string_lossy().into_owned();
        let was_folder = !path.is_empty() && on_disk.is_dir();
        if was_folder {
            place.push('/');
            if on_disk.join("README.md").is_file() {
                place.push_str("README.md");
            }
        } else if !on_disk.is_file() {
            return Err(format!("there is no {place}"));
        }
        if let Some(anchor) = anchor {
            let text = fs::read_to_string(root.join(&place)).map_err(|error| format!("{place}: {error}"))?;
            let anchors = markdown::anchors(&text);
            if !anchors.iter().any(|known| known == anchor) {
                return Err(format!("{place} has no heading #{anchor}; it has {}", anchors.join(", ")));
            }
        }
        Ok(Self { place, was_folder })
    }

    fn is_picture(&self) -> bool {
        [".png", ".svg", ".jpg"].iter().any(|end| self.place.ends_with(end))
    }

    /// The address that leads there in the book.
    fn address_in_book(&self, address: &str) -> String {
        let (path, anchor) = address.find('#').map_or((address, ""), |at| address.split_at(at));
        if path.is_empty() || self.is_picture() {
            return address.to_owned();
        }
        let file =
            if self.was_folder { format!("{}/index.md", path.trim_end_matches('/')) } else { file_of(path) };
        file + anchor
    }
}

/// A path without `.` and `..`; `None` if it leads above its begin.
fn plain(path: &Path) -> Option<PathBuf> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => plain.push(name),
            Component::CurDir => {}
            Component::ParentDir if plain.pop() => {}
            _ => return None,
        }
    }
    Some(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_addresses() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let to = |from: &str, address: &str| {
            Target::of(root, from, address).map(|target| (target.address_in_book(address), target.place))
        };
        let found = |address: &str, place: &str| Ok((address.to_owned(), place.to_owned()));
        assert_eq!(to("docs/rest.md", "equations.md"), found("equations.md", "docs/equations.md"));
        assert_eq!(to("docs/rest.md", "../README.md#cite"), found("../index.md#cite", "README.md"));
        assert_eq!(to("docs/rest.md", "decisions/"), found("decisions/index.md", "docs/decisions/"));
        assert_eq!(to("README.md", "validation/"), found("validation/index.md", "validation/README.md"));
        assert_eq!(to("docs/rest.md", "../references.bib"), found("../references.bib.md", "references.bib"));
        assert_eq!(to("README.md", "docs/figures/demo.png").unwrap().0, "docs/figures/demo.png");
        for wrong in ["gone.md", "../../outside.md", "equations.md#gone", "#gone"] {
            assert!(to("docs/rest.md", wrong).is_err(), "{wrong}");
        }
    }
}
