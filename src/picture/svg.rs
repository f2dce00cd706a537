//! Drawings as SVG, static or animated (SMIL).

use std::fmt::Write;

use super::arrow::OUTLINE;
use super::shapes::{Colour, Drawing, FRAME_MS, LAST_FRAME_MS, Shape};
use crate::page::escaped;

/// Renders an SVG document.
pub(super) fn document(drawing: &Drawing) -> String {
    let (width, height) = (drawing.width, drawing.height);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" \
         font-family=\"DejaVu Sans, Verdana, sans-serif\">\n<title>{}</title>\n<defs>\
         <path id=\"a\" d=\"{}\"/></defs>\n",
        escaped(&drawing.title),
        arrow_path()
    );
    let clock = Clock::new(drawing.frames.len());
    for shape in &drawing.ground {
        element(&mut text, &[shape], &clock);
    }
    for number in 0..drawing.frames[0].len() {
        let track: Vec<&Shape> = drawing.frames.iter().map(|frame| &frame[number]).collect();
        element(&mut text, &track, &clock);
    }
    for shape in &drawing.labels {
        element(&mut text, &[shape], &clock);
    }
    text.push_str("</svg>\n");
    text
}

fn arrow_path() -> String {
    let points = OUTLINE.map(|(x, y)| format!("{} {}", short(x), short(y)));
    format!("M{}z", points.join("L"))
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

    /// Returns the timing attributes of every animation. Values change without interpolation.
    fn attributes(&self) -> String {
        format!(
            "keyTimes=\"{}\" dur=\"{}ms\" calcMode=\"discrete\" repeatCount=\"indefinite\"",
            self.key_times, self.total_ms
        )
    }

    /// Animates an attribute, unless all its values are equal.
    fn animate(&self, text: &mut String, kind: &str, attribute: &str, values: &[String]) {
        if values.iter().all(|value| *value == values[0]) {
            return;
        }
        let (values, time) = (values.join(";"), self.attributes());
        let _ = write!(
            text,
            "<{kind} attributeName=\"{attribute}\" {time} values=\"{values}\"/>"
        );
    }
}

/// Returns the last value, which viewers without animation show.
fn still(values: &[String]) -> &str {
    values.last().map_or("", String::as_str)
}

/// Writes a shape over all frames; nothing if it is never visible.
fn element(text: &mut String, track: &[&Shape], clock: &Clock) {
    // Writing to a string cannot fail.
    let _ = match track[0] {
        Shape::Rect { .. } => rect(text, track, clock),
        Shape::Line { .. } => line(text, track, clock),
        Shape::Arrow { .. } => arrow(text, track, clock),
        Shape::Text { .. } => words(text, track, clock),
    };
}

fn rect(text: &mut String, track: &[&Shape], clock: &Clock) -> std::fmt::Result {
    let Shape::Rect {
        left,
        top,
        width,
        height,
        ..
    } = track[0]
    else {
        return Ok(());
    };
    let fills = track.iter().filter_map(|shape| match shape {
        Shape::Rect { fill, .. } => Some(hex(*fill)),
        _ => None,
    });
    let fills: Vec<String> = fills.collect();
    let [left, top, width, height] = [left, top, width, height].map(|&length| short(length));
    write!(
        text,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"{}\">",
        still(&fills)
    )?;
    clock.animate(text, "animate", "fill", &fills);
    text.write_str("</rect>\n")
}

fn line(text: &mut String, track: &[&Shape], clock: &Clock) -> std::fmt::Result {
    let Shape::Line { width, colour, .. } = track[0] else {
        return Ok(());
    };
    let lines = track.iter().filter_map(|shape| match shape {
        Shape::Line { points, .. } => Some(points.as_slice()),
        _ => None,
    });
    let longest = lines.clone().map(<[_]>::len).max().unwrap_or(0);
    let lines: Vec<String> = lines.map(|points| padded_points(points, longest)).collect();
    write!(
        text,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" \
         stroke-linecap=\"round\" stroke-linejoin=\"round\">",
        still(&lines),
        hex(*colour),
        short(*width)
    )?;
    clock.animate(text, "animate", "points", &lines);
    text.write_str("</polyline>\n")
}

/// Formats the points of a line and repeats the last point up to `longest` points. Viewers differ
/// in how they blend lines of different lengths.
fn padded_points(points: &[(f64, f64)], longest: usize) -> String {
    let last = points.iter().cycle().skip(points.len().saturating_sub(1));
    let padding = last.step_by(points.len().max(1));
    let points = points.iter().chain(padding).take(longest);
    let points = points.map(|(x, y)| format!("{},{}", short(*x), short(*y)));
    points.collect::<Vec<_>>().join(" ")
}

fn arrow(text: &mut String, track: &[&Shape], clock: &Clock) -> std::fmt::Result {
    let Shape::Arrow { tail, heading, .. } = track[0] else {
        return Ok(());
    };
    let looks = track.iter().filter_map(|shape| match shape {
        Shape::Arrow { length, fill, .. } => Some((decimals(*length, 1), hex(*fill))),
        _ => None,
    });
    let (lengths, fills): (Vec<String>, Vec<String>) = looks.unzip();
    if lengths.iter().all(|length| length == "0") {
        return Ok(());
    }
    write!(
        text,
        "<g transform=\"translate({} {})rotate({})\"><use href=\"#a\" \
         transform=\"scale({})\" fill=\"{}\">",
        short(tail.0),
        short(tail.1),
        heading.degrees(),
        still(&lengths),
        still(&fills)
    )?;
    let kind = "animateTransform type=\"scale\"";
    clock.animate(text, kind, "transform", &lengths);
    clock.animate(text, "animate", "fill", &fills);
    text.write_str("</use></g>\n")
}

/// Writes the text of each frame as its own element, because text cannot be animated.
fn words(text: &mut String, track: &[&Shape], clock: &Clock) -> std::fmt::Result {
    for (number, shape) in track.iter().enumerate() {
        let Shape::Text {
            at,
            size,
            colour,
            text: said,
        } = shape
        else {
            continue;
        };
        let (x, y) = (short(at.0), short(at.1));
        write!(
            text,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" fill=\"{}\"",
            short(*size),
            hex(*colour)
        )?;
        // The last frame is visible without animation; see [`still`].
        let shown = |at: usize| if at == number { "inline" } else { "none" };
        let now = shown(track.len() - 1);
        let hidden = if now == "none" {
            " display=\"none\""
        } else {
            ""
        };
        write!(text, "{hidden}>{}", escaped(said))?;
        let values: Vec<String> = (0..track.len()).map(|at| shown(at).to_owned()).collect();
        clock.animate(text, "animate", "display", &values);
        text.write_str("</text>\n")?;
    }
    Ok(())
}

fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Formats a length with at most two decimals.
fn short(length: f64) -> String {
    decimals(length, 2)
}

/// Formats a number with at most `most` decimals.
fn decimals(number: f64, most: usize) -> String {
    let text = format!("{number:.most$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::super::arrow::Heading;
    use super::*;
    use crate::world::Direction;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        assert_eq!(short(12.0), "12");
        assert_eq!(short(0.5), "0.5");
        assert_eq!(short(100.0), "100");
        assert_eq!(short(1.239), "1.24");
        assert_eq!(decimals(0.0, 1), "0");
    }

    #[test]
    fn text_of_a_world_cannot_become_markup() {
        assert_eq!(escaped("<b>&"), "&lt;b&gt;&amp;");
    }

    /// Returns a frame with each kind of shape that changes.
    fn frame(fill: Colour, length: f64, said: &str) -> Vec<Shape> {
        let (left, top, width, height) = (0.0, 0.0, 8.0, 8.0);
        let heading = Heading::new(Direction::East);
        let (at, tail, text) = ((0.0, 9.0), (1.0, 1.0), said.to_owned());
        let points = vec![(0.0, 0.0), (length, 0.0)];
        vec![
            Shape::Rect {
                left,
                top,
                width,
                height,
                fill,
            },
            Shape::Line {
                points,
                width,
                colour: Colour(0, 0, 0),
            },
            Shape::Arrow {
                tail,
                heading,
                length,
                fill,
            },
            Shape::Text {
                at,
                size: 9.0,
                colour: Colour(0, 0, 0),
                text,
            },
        ]
    }

    /// Returns what a viewer without animation support shows.
    fn without_animation(svg: &str) -> String {
        let lines = svg
            .lines()
            .filter(|line| !line.contains(" display=\"none\""));
        let mut shown = lines.collect::<Vec<_>>().join("\n");
        while let Some(from) = shown.find("<animate") {
            let to = from + shown[from..].find("/>").unwrap() + 2;
            shown.replace_range(from..to, "");
        }
        shown + "\n"
    }

    #[test]
    fn viewers_without_animation_show_the_last_frame_in_all_its_parts() {
        let first = frame(Colour(200, 0, 0), 2.0, "one");
        let last = frame(Colour(0, 200, 0), 5.0, "two");
        let svg = |frames| {
            document(&Drawing {
                width: 9,
                height: 9,
                title: String::new(),
                ground: vec![],
                frames,
                labels: vec![],
            })
        };
        let moving = svg(vec![first.clone(), last.clone()]);
        assert_eq!(moving.matches("<animate").count(), 6, "{moving}");
        assert_eq!(without_animation(&moving), svg(vec![last]));
        assert_ne!(without_animation(&moving), svg(vec![first]), "control");
    }
}
