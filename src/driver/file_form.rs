//! Forms of the files that a run writes.

use super::part_form::PartForm;

/// What is written into a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// NC text of any control.
    Nc,
    /// JSON: certificate, source map.
    Json,
    /// A page for a browser.
    Page,
    /// A page for a browser, or Markdown.
    Sheet,
    /// A PNG picture.
    Picture,
    /// A job.
    Job,
    /// The part.
    Part(&'static PartForm),
}

impl Form {
    /// Endings that the form has; none where many are usual.
    pub(super) fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Nc => &[],
            // Source maps are often named so.
            Self::Json => &["json", "map"],
            Self::Page => &["html", "htm"],
            Self::Sheet => &["html", "htm", "md", "markdown", "txt"],
            Self::Picture => &["png"],
            Self::Job => &["imp"],
            Self::Part(form) => form.endings,
        }
    }

    /// What the file is.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nc => "NC text",
            Self::Json => "JSON",
            Self::Page => "a page for a browser",
            Self::Sheet => "a page for a browser or Markdown",
            Self::Picture => "a PNG picture",
            Self::Job => "a job",
            Self::Part(form) => form.file,
        }
    }
}
