//! SVG documents, static or animated (SMIL).

use std::fmt::Write;

use crate::page::escaped;

/// Duration of a frame of an animation, in milliseconds.
pub(super) const FRAME_MS: u32 = 250;
/// Duration of the last frame, in milliseconds.
pub(super) const LAST_FRAME_MS: u32 = 3000;
/// The attribute that scales an element about its origin.
pub(super) const SCALE: &str = "scale";

/// An element. All lengths are in pixels of the picture; y points down.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    text: String,
    /// The transformation of the group that contains the element; empty without a group.
    group: String,
}

/// A picture of one frame or several. All frames have the same kinds of elements, with the same
/// attributes, in the same order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawing {
    pub width: u32,
    pub height: u32,
    pub title: String,
    /// The elements that others use by their identifiers.
    pub definitions: &'static str,
    /// The static elements below the frames.
    pub ground: Vec<Element>,
    /// The elements of each frame; at least one frame.
    pub frames: Vec<Vec<Element>>,
    /// The static elements above the frames.
    pub labels: Vec<Element>,
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
    /// Renders all frames as a document.
    pub fn document(&self) -> String {
        self.document_of(&self.frames)
    }

    /// Renders some of the frames as a document.
    pub fn document_of(&self, frames: &[Vec<Element>]) -> String {
        let (width, height) = (self.width, self.height);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\">\n<title>{}</title>\n\
             <defs>{}</defs>\n",
            escaped(&self.title),
            self.definitions
        );
        let clock = Clock::new(frames.len());
        for element in &self.ground {
            write(&mut text, &[element], &clock);
        }
        for number in 0..frames[0].len() {
            let track: Vec<&Element> = frames.iter().map(|frame| &frame[number]).collect();
            write(&mut text, &track, &clock);
        }
        for element in &self.labels {
            write(&mut text, &[element], &clock);
        }
        text.push_str("</svg>\n");
        text
    }
}

/// The start of each frame, as a share of the total duration.
struct Clock {
    key_times: String,
    total_ms: u32,
}

impl Clock {
    fn new(frames: usize) -> Self {
        let total_ms = (frames as u32 - 1) * FRAME_MS + LAST_FRAME_MS;
        let share = |frame: usize| frame as f64 * f64::from(FRAME_MS) / f64::from(total_ms);
        let shares: Vec<String> = (0..frames).map(|frame| decimals(share(frame), 3)).collect();
        Self {
            key_times: shares.join(";"),
            total_ms,
        }
    }

    /// Returns the animation of an attribute; empty if all its values are equal. Values change
    /// without interpolation.
    fn animation(&self, name: &str, values: &[&str]) -> String {
        if values.iter().all(|value| *value == values[0]) {
            return String::new();
        }
        let what = match name {
            SCALE => "animateTransform type=\"scale\" attributeName=\"transform\"".to_owned(),
            _ => format!("animate attributeName=\"{name}\""),
        };
        let (times, total_ms, values) = (&self.key_times, self.total_ms, values.join(";"));
        format!(
            "<{what} keyTimes=\"{times}\" dur=\"{total_ms}ms\" calcMode=\"discrete\" \
             repeatCount=\"indefinite\" values=\"{values}\"/>"
        )
    }
}

/// Writes an element over all frames; nothing if it is never visible. Viewers without animation
/// show the last frame.
fn write(out: &mut String, track: &[&Element], clock: &Clock) {
    let last = track[track.len() - 1];
    if track.iter().all(|element| element.is_hidden()) {
        return;
    }
    if track.iter().any(|element| element.text != last.text) {
        return write_texts(out, track, clock);
    }
    let (tag, is_grouped) = (last.tag, !last.group.is_empty());
    if is_grouped {
        let _ = write!(out, "<g transform=\"{}\">", last.group);
    }
    let _ = write!(out, "<{tag}");
    for (name, value) in &last.attributes {
        let _ = match *name {
            SCALE => write!(out, " transform=\"scale({value})\""),
            _ => write!(out, " {name}=\"{value}\""),
        };
    }
    let _ = write!(out, ">{}", escaped(&last.text));
    for (number, (name, _)) in last.attributes.iter().enumerate() {
        let values = track
            .iter()
            .map(|element| element.attributes[number].1.as_str());
        out.push_str(&clock.animation(name, &values.collect::<Vec<_>>()));
    }
    let _ = write!(out, "</{tag}>{}", if is_grouped { "</g>\n" } else { "\n" });
}

/// Writes the text of each frame as its own element, because text cannot be animated.
fn write_texts(out: &mut String, track: &[&Element], clock: &Clock) {
    for (own, element) in track.iter().enumerate() {
        let shown = (0..track.len()).map(|at| {
            let display = if at == own { "inline" } else { "none" };
            let mut element = (*element).clone();
            element.attributes.push(("display", display.to_owned()));
            element
        });
        let shown: Vec<Element> = shown.collect();
        write(out, &shown.iter().collect::<Vec<_>>(), clock);
    }
}

/// Formats a length with at most two decimals.
pub(super) fn short(length: f64) -> String {
    decimals(length, 2)
}

/// Formats a number with at most `most` decimals.
pub(super) fn decimals(number: f64, most: usize) -> String {
    let text = format!("{number:.most$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
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

    /// Returns a frame with each kind of attribute that changes.
    fn frame(fill: &str, scale: &str, said: &str) -> Vec<Element> {
        let fill = ("fill", fill.to_owned());
        vec![
            Element::new("rect", [("width", "8".to_owned()), fill.clone()]),
            Element::new("polyline", [("points", format!("0,0 {scale},0"))]),
            Element::new("use", [(SCALE, scale.to_owned()), fill]).in_group("rotate(45)".into()),
            Element::new("text", []).with_text(said),
        ]
    }

    /// Returns what a viewer without animation support shows.
    fn without_animation(svg: &str) -> String {
        let lines = svg
            .lines()
            .filter(|line| !line.contains(" display=\"none\""));
        let shown = lines.collect::<Vec<_>>().join("\n");
        let mut shown = shown.replace(" display=\"inline\"", "");
        while let Some(from) = shown.find("<animate") {
            let to = from + shown[from..].find("/>").unwrap() + 2;
            shown.replace_range(from..to, "");
        }
        shown + "\n"
    }

    #[test]
    fn viewers_without_animation_show_the_last_frame_in_all_its_parts() {
        let (first, last) = (frame("#c00", "2", "one"), frame("#0c0", "5", "two"));
        let svg = |frames| {
            let drawing = Drawing {
                width: 9,
                height: 9,
                title: String::new(),
                definitions: "",
                ground: vec![],
                frames,
                labels: vec![],
            };
            drawing.document()
        };
        let moving = svg(vec![first.clone(), last.clone()]);
        assert_eq!(moving.matches("<animate").count(), 6, "{moving}");
        assert_eq!(without_animation(&moving), svg(vec![last]));
        assert_ne!(without_animation(&moving), svg(vec![first]), "control");
    }
}
