//! SVG documents.

use std::fmt::Write;

use crate::page::escaped;

/// The attribute that scales an element about its origin.
pub(super) const SCALE: &str = "scale";

/// An element. All lengths are in pixels of the picture; y points down.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    text: String,
    /// The transformation of the group that contains the element; empty without a group.
    group: String,
}

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawing {
    pub width: u32,
    pub height: u32,
    pub title: String,
    /// The elements that others use by their identifiers.
    pub definitions: &'static str,
    /// The elements, from the ground up.
    pub elements: Vec<Element>,
}

impl Element {
    /// Creates an element without text.
    pub fn new<const N: usize>(tag: &'static str, attributes: [(&'static str, String); N]) -> Self {
        Self {
            tag,
            attributes: attributes.into(),
            text: String::new(),
            group: String::new(),
        }
    }

    /// Adds attributes.
    pub fn with<const N: usize>(mut self, attributes: [(&'static str, String); N]) -> Self {
        self.attributes.extend(attributes);
        self
    }

    /// Sets the text inside the element.
    pub fn with_text(self, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { text, ..self }
    }

    /// Puts the element into a group with a transformation.
    pub fn in_group(self, group: String) -> Self {
        Self { group, ..self }
    }

    /// Returns true if the element is scaled to nothing.
    fn is_hidden(&self) -> bool {
        let mut attributes = self.attributes.iter();
        attributes.any(|(name, value)| *name == SCALE && value == "0")
    }
}

impl Drawing {
    /// Renders a document.
    pub fn document(&self) -> String {
        let (width, height) = (self.width, self.height);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\">\n<title>{}</title>\n\
             <defs>{}</defs>\n",
            escaped(&self.title),
            self.definitions
        );
        for element in &self.elements {
            write(&mut text, element);
        }
        text.push_str(
            "</svg>
",
        );
        text
    }
}

/// Writes an element; nothing if it is invisible.
fn write(out: &mut String, element: &Element) {
    if element.is_hidden() {
        return;
    }
    let (tag, is_grouped) = (element.tag, !element.group.is_empty());
    if is_grouped {
        let _ = write!(out, "<g transform=\"{}\">", element.group);
    }
    let _ = write!(out, "<{tag}");
    for (name, value) in &element.attributes {
        let _ = match *name {
            SCALE => write!(out, " transform=\"scale({value})\""),
            _ => write!(out, " {name}=\"{value}\""),
        };
    }
    let _ = write!(out, ">{}", escaped(&element.text));
    let _ = write!(out, "</{tag}>{}", if is_grouped { "</g>\n" } else { "\n" });
}

/// Formats a length with at most two decimals.
pub(crate) fn short(length: f64) -> String {
    decimals(length, 2)
}

/// Formats a number with at most `most` decimals.
pub(crate) fn decimals(number: f64, most: usize) -> String {
    let text = format!("{number:.most$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        assert_eq!(short(12.0), "12");
        assert_eq!(short(0.5), "0.5");
        assert_eq!(short(100.0), "100");
        assert_eq!(short(1.239), "1.24");
        assert_eq!(decimals(0.0, 1), "0");
    }
}
