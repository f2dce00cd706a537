//! `/scene/caption`: a caption north of the maze.

use foxglove::messages::{SceneUpdate, TextPrimitive};

use super::rule;
use super::scene::{GRID, entity, label, place, size_m, update};
use xcscr_robot::world::Maze;

const TITLE: u32 = 0xffffff;
const HEADING: u32 = 0x9aa5b8;
/// The height of a title as a share of the maze's longer side.
const SIZE: f64 = 0.062;
/// The width of a letter, as a share of its height. Text wider than the share [`WIDEST`] of the
/// maze is scaled down.
const LETTER: f64 = 0.6;
const WIDEST: f64 = 1.35;

/// A caption of two lines.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Caption {
    /// What is shown.
    pub title: String,
    /// World, method, arena, sensor and seed.
    pub heading: String,
}

impl Caption {
    /// Returns the caption as a scene.
    pub fn scene(&self, maze: &Maze, time_ns: u64) -> SceneUpdate {
        let mut lines = entity("caption", GRID, time_ns);
        let all = [
            (&self.heading, 3.9, 0.7, HEADING),
            (&self.title, 2.45, 1.0, TITLE),
        ];
        let shown = all.into_iter().filter(|(text, ..)| !text.is_empty());
        lines.texts = shown
            .map(|(text, up, size, rgb)| line(maze, text, up, size, rgb))
            .collect();
        update(vec![lines])
    }
}

/// Returns how far a caption extends north of the maze, in metres.
pub(crate) fn height_m(maze: &Maze) -> f64 {
    4.6 * title_height_m(maze) + clearance_m(maze)
}

/// Returns the extra distance, in metres, between caption and maze that the text over a robot
/// needs.
fn clearance_m(maze: &Maze) -> f64 {
    (rule::reach_m(maze) - 0.6 * title_height_m(maze)).max(0.0)
}

fn title_height_m(maze: &Maze) -> f64 {
    SIZE * f64::from(maze.width().max(maze.height())) * maze.cell_size_m()
}

/// Creates a line whose middle is `up` title heights above the bottom of the caption. `share` is
/// the letter height as a share of the title height.
fn line(maze: &Maze, text: &str, up: f64, share: f64, rgb: u32) -> TextPrimitive {
    let ([wide, high], title) = (size_m(maze), title_height_m(maze));
    let fits = WIDEST * wide / (LETTER * text.chars().count() as f64);
    let at = place(wide / 2.0, high + clearance_m(maze) + up * title, 0.0);
    label(at, fits.min(share * title), rgb, text)
}
