//! Errors in world files, with their location in the file.

use std::fmt;
use std::io;
use std::path::PathBuf;

use annotate_snippets::{
    Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str,
};

use super::location::Location;

/// The world cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// There is no such file.
    #[error("there is no world file `{}`{}", .path.display(), did_you_mean(.near))]
    Missing {
        /// The requested file.
        path: PathBuf,
        /// Files with similar names.
        near: Vec<PathBuf>,
    },
    /// The file exists, but cannot be read.
    #[error("cannot read the world file `{}`: {source}", .path.display())]
    Unreadable {
        /// The requested file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The file was read, but does not describe a valid world.
    #[error(transparent)]
    Invalid(Box<Diagnostic>),
}

fn did_you_mean(near: &[PathBuf]) -> String {
    let names: Vec<String> = near.iter().map(|path| path.display().to_string()).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!("; did you mean {}?", names.join(" or ")),
    }
}

/// An error in a text: what is wrong, where, and how to fix it.
///
/// Its `Display` is plain text of several lines: the cause, file, line and column, the line itself
/// with a caret under the location, and a help line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.render(&Renderer::plain()))]
pub struct Diagnostic {
    pub(super) origin: String,
    pub(super) title: String,
    /// The location of the fault first, then locations that explain it.
    pub(super) locations: Vec<Location>,
    pub(super) help: String,
}

impl Diagnostic {
    /// Returns the cause in one line.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Returns line and column of the fault, counted from 1, the column in characters. Returns
    /// `None` if the fault has no location, for example a file that is too large.
    pub fn position(&self) -> Option<(usize, usize)> {
        self.locations
            .first()
            .map(|location| (location.line, location.column))
    }

    /// Returns the message with colours, for a terminal.
    pub fn styled(&self) -> impl fmt::Display {
        self.render(&Renderer::styled())
    }

    fn render(&self, renderer: &Renderer) -> String {
        let title = Level::ERROR.no_name().primary_title(self.title.as_str());
        let mut group = Group::with_title(title);
        // For a cut line, a snippet would count the column from the cut.
        let is_cut = self.locations.iter().any(|location| location.is_cut);
        match self.locations.first() {
            None => group = group.element(self.origin()),
            Some(location) if is_cut => {
                let origin = self
                    .origin()
                    .line(location.line)
                    .char_column(location.column);
                group = group.element(origin).elements(self.snippets(None));
            }
            Some(_) => group = group.elements(self.snippets(Some(&self.origin))),
        }
        let text = renderer.render(&[group.element(Level::HELP.message(self.help.as_str()))]);
        // Drop the marker line of a snippet without a path.
        let lines: Vec<&str> = text.lines().filter(|line| line.trim() != ":::").collect();
        lines.join("\n")
    }

    fn origin(&self) -> Origin<'_> {
        Origin::path(normalize_untrusted_str(&self.origin))
    }

    /// Returns one snippet per line with a location, the line with the fault first.
    fn snippets<'a>(&'a self, path: Option<&'a str>) -> Vec<Snippet<'a, Annotation<'a>>> {
        let mut lines: Vec<&Location> = self.locations.iter().collect();
        lines.dedup_by(|a, b| a.shares_line_with(b));
        lines
            .into_iter()
            .map(|line| self.snippet(line).path(path.map(normalize_untrusted_str)))
            .collect()
    }

    fn snippet<'a>(&'a self, line: &'a Location) -> Snippet<'a, Annotation<'a>> {
        let annotations = self
            .locations
            .iter()
            .enumerate()
            .filter(|(_, location)| location.shares_line_with(line))
            .map(|(i, location)| {
                let kind = match i {
                    0 => AnnotationKind::Primary,
                    _ => AnnotationKind::Context,
                };
                kind.span(location.span.clone())
                    .label(location.label.as_str())
            });
        Snippet::source(line.excerpt.as_str())
            .line_start(line.line)
            .annotations(annotations)
    }
}
