//! What a drawing consists of: the few shapes that both SVG and pixels know.

use super::arrow::Heading;

/// A colour: red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// The colour `0xRRGGBB`.
    pub const fn hex(rgb: u32) -> Self {
        Self((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
    }

    /// On the way from this colour to another; `share` runs from 0 to 1.
    pub fn toward(self, other: Self, share: f64) -> Self {
        let blend = |from: u8, to: u8| {
            let (from, to) = (f64::from(from), f64::from(to));
            (from + (to - from) * share.clamp(0.0, 1.0)).round() as u8
        };
        Self(
            blend(self.0, other.0),
            blend(self.1, other.1),
            blend(self.2, other.2),
        )
    }
}

/// A shape. All lengths are in pixels of the figure, y downward.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// A box.
    Rect {
        left: f64,
        top: f64,
        width: f64,
        height: f64,
        fill: Colour,
    },
    /// A line with round ends through points.
    Line {
        points: Vec<(f64, f64)>,
        width: f64,
        colour: Colour,
    },
    /// An arrow with its tail at a point; with length 0 it is not there.
    Arrow {
        tail: (f64, f64),
        heading: Heading,
        length: f64,
        fill: Colour,
    },
    /// Words that begin at a point of their base line.
    Text {
        at: (f64, f64),
        size: f64,
        colour: Colour,
        text: String,
    },
}

/// A picture, or several of which all have the same kinds of shapes in the same order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawing {
    pub width: u32,
    pub height: u32,
    pub title: String,
    /// What never changes and lies below everything.
    pub ground: Vec<Shape>,
    /// What changes, by moment; at least one.
    pub frames: Vec<Vec<Shape>>,
    /// What never changes and lies above everything.
    pub labels: Vec<Shape>,
}

impl Drawing {
    /// All shapes of one moment, the lowest first.
    pub fn shapes(&self, frame: usize) -> impl Iterator<Item = &Shape> {
        let frame = self.frames[frame].iter();
        self.ground.iter().chain(frame).chain(&self.labels)
    }
}

/// How long a moment of an animation lasts, in milliseconds.
pub(super) const MOMENT_MS: u32 = 250;
/// How long the last one does.
pub(super) const LAST_MS: u32 = 3000;
