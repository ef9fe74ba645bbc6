//! Which pages the site has, in which order.

/// The page that `granflow verify` fills, and all other chapters, by part: paths in the repository.
pub const PARTS: [(&str, &[&str]); 4] = [
    (
        "Using it",
        &[
            "docs/first-steps.md",
            "docs/hazard.md",
            "docs/case-file.md",
            "docs/outputs.md",
            "docs/ensemble.md",
            "docs/python.md",
            "docs/web.md",
            "docs/qgis.md",
            "docs/glossary.md",
            "cases/",
        ],
    ),
    (
        "How it computes",
        &["docs/equations.md", "docs/schemes.md", "docs/rest.md", "docs/determinism.md", "docs/errata.md"],
    ),
    (
        "How far to trust it",
        &["docs/verification.md", "docs/validation.md", "validation/README.md", "docs/performance.md"],
    ),
    (
        "Working on it",
        &["docs/library.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "docs/decisions/", "CHANGELOG.md"],
    ),
];

/// The first page.
pub const FRONT: &str = "README.md";

/// Its text ends with what `granflow verify` found.
pub const VERIFICATION: &str = "docs/verification.md";

/// Its text ends with the way to the pages that rustdoc made.
pub const LIBRARY: &str = "docs/library.md";

/// Pages that the others link, in the order in which they were met.
pub const LINKED: &str = "Files";
