//! What can be wrong with a world file, told with the place in the file.

use std::fmt;
use std::io;
use std::path::PathBuf;

use annotate_snippets::{
    Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str,
};

use super::place::Place;

/// A world that cannot be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// There is no such file.
    #[error("there is no world file `{}`{}", .path.display(), did_you_mean(.near))]
    Missing {
        /// The file asked for.
        path: PathBuf,
        /// Files that may have been meant.
        near: Vec<PathBuf>,
    },
    /// The file exists, but cannot be read.
    #[error("cannot read the world file `{}`: {source}", .path.display())]
    Unreadable {
        /// The file asked for.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file was read, but describes no world.
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

/// What is wrong in a text, where, and how to put it right.
///
/// Its `Display` is plain text of several lines: the cause, file, line and column, the line
/// itself with a caret under the place, and a help line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.render(&Renderer::plain()))]
pub struct Diagnostic {
    pub(super) origin: String,
    pub(super) title: String,
    /// The place of the fault first, then places that explain it.
    pub(super) places: Vec<Place>,
    pub(super) help: String,
}

impl Diagnostic {
    /// What is wrong, in one line.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Line and column of the fault, counted from 1, the column in characters; `None` when the
    /// fault has no place, such as a file that is too large.
    pub fn position(&self) -> Option<(usize, usize)> {
        self.places.first().map(|place| (place.line, place.column))
    }

    /// The message with colours, for a terminal.
    pub fn styled(&self) -> impl fmt::Display {
        self.render(&Renderer::styled())
    }

    fn render(&self, renderer: &Renderer) -> String {
        let title = Level::ERROR.no_name().primary_title(self.title.as_str());
        let mut group = Group::with_title(title);
        // A snippet counts the column from where its line was cut off.
        let is_cut = self.places.iter().any(|place| place.is_cut);
        match self.places.first() {
            None => group = group.element(self.origin()),
            Some(place) if is_cut => {
                let origin = self.origin().line(place.line).char_column(place.column);
                group = group.element(origin).elements(self.snippets(None));
            }
            Some(_) => group = group.elements(self.snippets(Some(&self.origin))),
        }
        let text = renderer.render(&[group.element(Level::HELP.message(self.help.as_str()))]);
        // The mark of a snippet without a path says nothing.
        let lines: Vec<&str> = text.lines().filter(|line| line.trim() != ":::").collect();
        lines.join("\n")
    }

    fn origin(&self) -> Origin<'_> {
        Origin::path(normalize_untrusted_str(&self.origin))
    }

    /// One snippet per line that holds a place, the line with the fault first.
    fn snippets<'a>(&'a self, path: Option<&'a str>) -> Vec<Snippet<'a, Annotation<'a>>> {
        let mut lines: Vec<&Place> = self.places.iter().collect();
        lines.dedup_by(|a, b| a.shares_line_with(b));
        lines
            .into_iter()
            .map(|line| self.snippet(line).path(path.map(normalize_untrusted_str)))
            .collect()
    }

    fn snippet<'a>(&'a self, line: &'a Place) -> Snippet<'a, Annotation<'a>> {
        let annotations = self
            .places
            .iter()
            .enumerate()
            .filter(|(_, place)| place.shares_line_with(line))
            .map(|(i, place)| {
                let kind = match i {
                    0 => AnnotationKind::Primary,
                    _ => AnnotationKind::Context,
                };
                kind.span(place.span.clone()).label(place.label.as_str())
            });
        Snippet::source(line.excerpt.as_str())
            .line_start(line.line)
            .annotations(annotations)
    }
}
