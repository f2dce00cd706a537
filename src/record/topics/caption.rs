//! `/scene/caption`: what is shown, in words, north of the maze.

use foxglove::messages::{SceneUpdate, TextPrimitive};

use super::rounded;
use super::rule;
use super::scene::{WORLD, color, entity, place, update};
use crate::world::Maze;

const TITLE: u32 = 0xffffff;
const REMARK: u32 = 0xf4b740;
const HEADING: u32 = 0x9aa5b8;
/// The height of a title as a share of the maze's longer side.
const SIZE: f64 = 0.062;
/// How wide a letter is, as a share of its height; text wider than this share of the maze is made
/// smaller.
const LETTER: f64 = 0.6;
const WIDEST: f64 = 1.35;

/// Three lines above each other.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::record) struct Caption {
    /// What is seen.
    pub title: String,
    /// What is remarkable about it.
    pub remark: String,
    /// World, method and seed.
    pub heading: String,
}

impl Caption {
    /// The caption as a scene.
    pub fn scene(&self, maze: &Maze, time_ns: u64) -> SceneUpdate {
        let mut lines = entity("caption", WORLD, time_ns);
        let all = [
            (&self.heading, 3.9, 0.7, HEADING),
            (&self.title, 2.45, 1.0, TITLE),
            (&self.remark, 1.05, 0.8, REMARK),
        ];
        let shown = all.into_iter().filter(|(text, ..)| !text.is_empty());
        lines.texts = shown
            .map(|(text, up, size, rgb)| line(maze, text, up, size, rgb))
            .collect();
        update(vec![lines])
    }

    /// Reads the lines of a caption's scene, which their colours tell apart.
    pub fn read(scene: &SceneUpdate) -> Self {
        let texts = || scene.entities.iter().flat_map(|entity| &entity.texts);
        let line = |rgb| {
            let found = texts().find(|text| text.color == color(rgb, 1.0));
            found.map_or_else(String::new, |text| text.text.clone())
        };
        Self {
            title: line(TITLE),
            remark: line(REMARK),
            heading: line(HEADING),
        }
    }
}

/// How far a caption reaches north of the maze, in metres.
pub(in crate::record) fn height_m(maze: &Maze) -> f64 {
    4.6 * title_height_m(maze) + clearance_m(maze)
}

/// How much farther north a caption begins than it would without words over a robot, in metres.
fn clearance_m(maze: &Maze) -> f64 {
    (rule::reach_m(maze) - 0.6 * title_height_m(maze)).max(0.0)
}

fn title_height_m(maze: &Maze) -> f64 {
    SIZE * f64::from(maze.width().max(maze.height())) * maze.cell_size_m()
}

/// A line whose middle is `up` title heights north of where the caption begins, and whose letters have a share of
/// that height.
fn line(maze: &Maze, text: &str, up: f64, share: f64, rgb: u32) -> TextPrimitive {
    let (unit, title) = (maze.cell_size_m(), title_height_m(maze));
    let (wide, high) = (
        f64::from(maze.width()) * unit,
        f64::from(maze.height()) * unit,
    );
    let fits = WIDEST * wide / (LETTER * text.chars().count() as f64);
    let at = place(wide / 2.0, high + clearance_m(maze) + up * title, 0.0);
    TextPrimitive {
        pose: at,
        billboard: true,
        font_size: rounded(fits.min(share * title)),
        scale_invariant: false,
        color: color(rgb, 1.0),
        text: text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caption_is_read_as_it_was_written_also_where_a_line_is_missing() {
        let world = br######"{ "rows": ["####", "#SG#", "####"] }"######;
        let maze = Maze::from_json(world, "m.json").unwrap();
        let mut caption = Caption {
            title: "a title".to_owned(),
            remark: "a remark".to_owned(),
            heading: "a heading".to_owned(),
        };
        assert_eq!(Caption::read(&caption.scene(&maze, 0)), caption);
        caption.remark.clear();
        assert_eq!(Caption::read(&caption.scene(&maze, 0)), caption);
    }
}
