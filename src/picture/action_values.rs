//! Draws the value of every action at some stages of learning, as Figures 2 and 5 of the paper do.

use std::collections::BTreeSet;

use super::drawing::{
    ARROW, FAINT, HEAD, INK, MARGIN, PAPER, Plane, VISITED, arrow, block, cell_px, words,
};
use super::policy_picture::{Moment, PolicyPicture};
use super::svg::{Drawing, Element};
use crate::record::colours::{ABOVE, BELOW};
use crate::world::{Cell, Direction};

/// The colour of the best actions on the greedy path.
const POLICY: u32 = 0x128a3e;
/// The colour of the cell in which the episode ended.
const END: u32 = 0x8f97a3;

/// Height of the captions and the legend below the mazes, in pixels.
const FOOT: f64 = 104.0;
/// Least width of a panel, so that its caption fits.
const LEAST_PANEL: f64 = 300.0;
/// Length of the arrow of the greatest value of a panel, in cells.
const LONGEST: f64 = 0.47;
/// Least length of an arrow, in cells, so that its colour is visible.
const SHORTEST: f64 = 0.1;

/// Draws one maze for each stage, side by side.
pub(super) fn draw(picture: &PolicyPicture) -> Drawing {
    let (maze, panels) = (&picture.maze, picture.moments.len());
    let cell = cell_px(maze, panels);
    let maze_px = f64::from(maze.width()) * cell;
    let panel = maze_px.max(LEAST_PANEL);
    let width = MARGIN + panels as f64 * (panel + MARGIN);
    let below = HEAD + f64::from(maze.height()) * cell;
    let mut elements = vec![block(0.0, 0.0, width, below + FOOT, PAPER)];
    let title = format!("{}: the value of every action", picture.title);
    elements.push(words(MARGIN, 26.0, 17.0, INK, title));
    let mut panel_left = MARGIN;
    for moment in &picture.moments {
        let left = panel_left + ((panel - maze_px) / 2.0).floor();
        let plane = Plane { maze, cell, left };
        elements.extend(plane.ground());
        elements.extend(plane.values(moment));
        for (line, text) in captions(moment).into_iter().enumerate() {
            let y = below + 20.0 + 17.0 * line as f64;
            elements.push(words(panel_left, y, 13.0, FAINT, text));
        }
        panel_left += panel + MARGIN;
    }
    elements.extend(legend(below + FOOT - 18.0, width));
    Drawing {
        width: width as u32,
        height: (below + FOOT) as u32,
        title: picture.title.clone(),
        definitions: ARROW,
        elements,
    }
}

impl Plane<'_> {
    /// Returns the visited cells, and an arrow for each action in each free cell.
    fn values(&self, moment: &Moment) -> Vec<Element> {
        let index = |cell: &Cell| self.maze.index(*cell);
        let visited: BTreeSet<usize> = moment.visited.iter().map(index).collect();
        let end = moment.visited.last().map(index);
        let fill = |cell| match self.maze.index(cell) {
            at if Some(at) == end => END,
            at if visited.contains(&at) => VISITED,
            _ => PAPER,
        };
        let cells = self.maze.free_cells();
        let mut shapes: Vec<Element> = cells.map(|cell| self.tile(cell, 0.5, fill(cell))).collect();
        shapes.extend(self.true_walls());
        let on_path: BTreeSet<usize> = moment.greedy_path.iter().map(index).collect();
        let greatest = greatest(moment).max(f64::MIN_POSITIVE);
        for (cell, values) in moment.policy.cells() {
            let directions = self.maze.moves().directions().iter();
            for (&direction, &value) in directions.zip(values.as_slice()) {
                let Some(value) = value.filter(|&value| value != 0.0) else {
                    continue;
                };
                let is_best = Some(value) == values.greatest();
                let colour = match () {
                    () if is_best && on_path.contains(&index(cell)) => POLICY,
                    () if value < 0.0 => BELOW,
                    () => ABOVE,
                };
                let length = (LONGEST * (value.abs() / greatest).sqrt()).max(SHORTEST);
                shapes.push(arrow(
                    self.centre(*cell),
                    direction,
                    length * self.cell,
                    colour,
                ));
            }
        }
        shapes.extend(self.letters());
        shapes
    }
}

/// Returns the greatest magnitude of a value.
fn greatest(moment: &Moment) -> f64 {
    let cells = moment.policy.cells();
    let values = cells.flat_map(|(_, values)| values.as_slice().iter().flatten().copied());
    values.map(f64::abs).fold(0.0, f64::max)
}

fn captions(moment: &Moment) -> [String; 2] {
    [
        moment.result(),
        format!(
            "longest arrow: {:.0}; length: square root",
            greatest(moment)
        ),
    ]
}

fn legend(y: f64, width: f64) -> Vec<Element> {
    let entries = [
        (POLICY, "best action on the greedy path"),
        (ABOVE, "above 0"),
        (BELOW, "below 0"),
    ];
    let mut shapes = Vec::new();
    let mut x = MARGIN;
    for (colour, text) in entries {
        shapes.push(arrow((x, y - 4.5), Direction::East, 26.0, colour));
        shapes.push(words(x + 32.0, y, 12.0, INK, text));
        x += 52.0 + 6.6 * text.len() as f64;
    }
    for (fill, text) in [(VISITED, "visited"), (END, "end of the episode")] {
        // A single panel is too narrow for the whole legend.
        if x + 24.0 + 6.6 * text.len() as f64 > width {
            break;
        }
        shapes.push(block(x, y - 13.0, 17.0, 17.0, fill));
        shapes.push(words(x + 23.0, y, 12.0, INK, text));
        x += 43.0 + 6.6 * text.len() as f64;
    }
    shapes
}
