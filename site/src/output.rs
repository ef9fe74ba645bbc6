//! What mdBook made: every link leads somewhere, and opening a page asks no network.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use html5ever::tendril::StrTendril;
use html5ever::tokenizer::{BufferQueue, Tag, TagKind, Token, TokenSink, TokenSinkResult, Tokenizer};

/// What matters of a page: its anchors, and the addresses that it names, each with whether the browser fetches it unasked.
#[derive(Default)]
struct Found {
    ids: BTreeSet<String>,
    addresses: Vec<(String, bool)>,
}

#[derive(Default)]
struct Sink(RefCell<Found>);

impl TokenSink for Sink {
    type Handle = ();

    fn process_token(&self, token: Token, _line: u64) -> TokenSinkResult<()> {
        if let Token::TagToken(Tag { kind: TagKind::StartTag, name, attrs, .. }) = token {
            let mut found = self.0.borrow_mut();
            for attribute in attrs {
                let value = attribute.value.to_string();
                match &*attribute.name.local {
                    "id" => drop(found.ids.insert(value)),
                    "href" => found.addresses.push((value, &*name != "a")),
                    "src" | "srcset" | "poster" | "data" | "action" => found.addresses.push((value, true)),
                    _ => {}
                }
            }
        }
        TokenSinkResult::Continue
    }
}

fn scan(html: &str) -> Found {
    let input = BufferQueue::default();
    input.push_back(StrTendril::from(html));
    let tokenizer = Tokenizer::new(Sink::default(), Default::default());
    let _ = tokenizer.feed(&input);
    tokenizer.end();
    tokenizer.sink.0.into_inner()
}

/// Looks through all pages and styles of `site`, but for the folder `api`, whose links rustdoc checks itself.
///
/// # Errors
/// Every link that leads nowhere, and every file that would be fetched from a network.
pub fn check(site: &Path) -> Result<usize> {
    let mut files = Vec::new();
    list(site, &mut files)?;
    let mut pages = BTreeMap::new();
    let mut faults = Vec::new();
    for file in files.iter().filter(|file| !file.starts_with(site.join("api"))) {
        let kind = file.extension().and_then(|end| end.to_str());
        if kind == Some("html") {
            pages.insert(file.clone(), scan(&fs::read_to_string(file)?));
        } else if kind == Some("css") {
            let text = fs::read_to_string(file)?;
            let far = ["url(http", "url(\"http", "url('http", "url(//", "@import"];
            faults.extend(
                far.iter()
                    .filter(|far| text.contains(*far))
                    .map(|far| format!("{}: {far} would be fetched from a network", file.display())),
            );
        }
    }
    for (page, found) in &pages {
        for (address, fetched) in &found.addresses {
            if let Err(fault) = resolve(page, address, *fetched, &pages) {
                faults.push(format!("{}: {fault}", page.strip_prefix(site).unwrap_or(page).display()));
            }
        }
    }
    if !faults.is_empty() {
        bail!("{}", faults.join("\n"));
    }
    Ok(pages.len())
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("{}", folder.display()))? {
        let path = entry?.path();
        if path.is_dir() { list(&path, files)? } else { files.push(path) }
    }
    Ok(())
}

fn resolve(
    page: &Path,
    address: &str,
    fetched: bool,
    pages: &BTreeMap<PathBuf, Found>,
) -> Result<(), String> {
    let remote =
        address.starts_with("//") || address.split('/').next().is_some_and(|begin| begin.contains(':'));
    if remote {
        let asks = fetched && !address.starts_with("data:");
        return if asks { Err(format!("{address} would be fetched from a network")) } else { Ok(()) };
    }
    let (path, anchor) = address.split_once('#').map_or((address, ""), |(path, anchor)| (path, anchor));
    let target = if path.is_empty() {
        page.to_owned()
    } else {
        let joined = page.parent().unwrap_or(Path::new("")).join(path);
        joined.canonicalize().map_err(|_| format!("{address} leads nowhere"))?
    };
    if target.is_dir() {
        return Err(format!("{address} is a folder; without a server it shows a list of files"));
    }
    match pages.get(&target) {
        Some(found) if !anchor.is_empty() && !found.ids.contains(anchor) => {
            Err(format!("{address}: the page has no such place"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `check` says of a site of these files.
    fn said(name: &str, files: &[(&str, &str)]) -> Result<usize, String> {
        let site = std::env::temp_dir().join(format!("granflow-site-{name}-{}", std::process::id()));
        fs::create_dir_all(&site).unwrap();
        let site = site.canonicalize().unwrap();
        for (file, text) in files {
            fs::write(site.join(file), text).unwrap();
        }
        let said =
            check(&site).map_err(|error| error.to_string().replace(&format!("{}/", site.display()), ""));
        fs::remove_dir_all(&site).unwrap();
        said
    }

    #[test]
    fn links_lead_somewhere() {
        let b = ("b.html", "<h2 id=\"here\">H</h2>");
        let a =
            "<a href=\"b.html#here\">b</a><a href=\"https://example.org\">far</a><a href=\"#x\" id=\"x\">";
        assert_eq!(said("good", &[("a.html", a), b]), Ok(2));
        let a = "<a href=\"c.html\">c</a><a href=\"b.html#gone\">b</a><img src=\"gone.png\">";
        let expected = "a.html: c.html leads nowhere\na.html: b.html#gone: the page has no such place\n\
                        a.html: gone.png leads nowhere";
        assert_eq!(said("bad", &[("a.html", a), b]), Err(expected.into()));
    }

    #[test]
    fn nothing_is_fetched_from_a_network() {
        for (k, html) in [
            "<script src=\"https://example.org/a.js\"></script>",
            "<link rel=stylesheet href=//example.org/a.css>",
            "<img src='http://example.org/a.png'>",
        ]
        .iter()
        .enumerate()
        {
            let error = said(&format!("far{k}"), &[("a.html", html)]).unwrap_err();
            assert!(error.ends_with("would be fetched from a network"), "{error}");
        }
        assert!(said("style", &[("a.css", "b { background: url(https://e.org/f.png) }")]).is_err());
    }
}
