//! The shapes of a drawing. Each can be rendered as SVG and as pixels.

use super::arrow::Heading;

/// A colour: red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Creates the colour `0xRRGGBB`.
    pub const fn hex(rgb: u32) -> Self {
        Self((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
    }

    /// Returns a blend of this colour and another. `share` ranges from 0 to 1.
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

/// A shape. All lengths are in pixels of the picture; y points down.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// A rectangle.
    Rect {
        left: f64,
        top: f64,
        width: f64,
        height: f64,
        fill: Colour,
    },
    /// A polyline with round ends.
    Line {
        points: Vec<(f64, f64)>,
        width: f64,
        colour: Colour,
    },
    /// An arrow with its tail at a point. An arrow of length 0 is invisible.
    Arrow {
        tail: (f64, f64),
        heading: Heading,
        length: f64,
        fill: Colour,
    },
    /// Text that begins at a point on its baseline.
    Text {
        at: (f64, f64),
        size: f64,
        colour: Colour,
        text: String,
    },
}

/// A picture of one frame or several. All frames have the same kinds of shapes in the same order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawing {
    pub width: u32,
    pub height: u32,
    pub title: String,
    /// The static shapes below the frames.
    pub ground: Vec<Shape>,
    /// The shapes of each frame; at least one frame.
    pub frames: Vec<Vec<Shape>>,
    /// The static shapes above the frames.
    pub labels: Vec<Shape>,
}

impl Drawing {
    /// Returns all shapes of a frame, the lowest first.
    pub fn shapes(&self, frame: usize) -> impl Iterator<Item = &Shape> {
        let frame = self.frames[frame].iter();
        self.ground.iter().chain(frame).chain(&self.labels)
    }
}

/// Duration of a frame of an animation, in milliseconds.
pub(super) const FRAME_MS: u32 = 250;
/// Duration of the last frame, in milliseconds.
pub(super) const LAST_FRAME_MS: u32 = 3000;
