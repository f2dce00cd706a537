//! `/scene/trail`: the robot's trajectory in this episode, and the wall hits.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use foxglove::messages::{Color, CylinderPrimitive, LinePrimitive, Point3, SceneUpdate};
use nalgebra::{Point2, Vector2};

use super::scene::{GRID, color, cylinder, entity, lines, place, point, update, vector};
use crate::arena::{Contact, View};
use crate::record::event::Pose;
use crate::world::{Cell, Maze};

pub(super) const HIT: u32 = 0xe0322f;
/// The colours of the trajectory from standstill to full speed.
const SPEEDS: [u32; 3] = [0x3a1d8a, 0xa82bd0, FASTEST];
pub(super) const FASTEST: u32 = 0xff6bd6;
/// Full speed, in cells per second.
const FAST: f64 = 1.3;
/// Exploratory moves are dashed. The length of a dash and of a gap, in cells.
const DASH: f64 = 0.12;
/// The number of pieces shown as they were driven. Earlier ones are shown as lines between cells,
/// whose number does not grow with the steps.
const MAX_PIECES: usize = 640;
/// The grid that the ends of pieces are aligned to, in cells; finer detail is not visible.
const FINENESS: f64 = 1.0 / 64.0;
/// Pieces are joined if this moves their common end by at most this much, in cells.
const MAX_OFFSET: f64 = 1.0 / 64.0;
/// The impulse with the largest mark, in N s: that of a robot at full speed.
const HARD_N_S: f64 = 8.0;
/// The maximum number of marks per episode. Later hits are on the other topics only.
const MAX_HITS: usize = 64;
/// Up to this many lines the trail is written after each step, and above that less and less often.
/// This keeps the copies of a long trail from filling the disk.
const SHORT: usize = 128;
/// Where the agent sets the speeds of the wheels, a step has 50 ms. Then the trail is written at most twice per second.
const WHEEL_STEPS: usize = 10;

/// The trajectory so far.
#[derive(Debug, Default)]
pub(in crate::record) struct Trail {
    /// By cell index: the number of the point where the robot first stood in the cell.
    visited: BTreeMap<usize, u32>,
    points: Vec<Point3>,
    /// The borders that were crossed, as the indices of both cells in ascending order.
    crossed: BTreeSet<[usize; 2]>,
    /// Two point numbers for each crossed border.
    lines: Vec<u32>,
    /// The trajectory as it was driven: its speed, as an index into the colours, and both ends.
    pieces: VecDeque<(usize, [Point3; 2])>,
    /// True if there are earlier pieces that are not shown.
    is_cut: bool,
    unit_m: f64,
    at: Option<Cell>,
    steps: usize,
    /// The minimum number of steps between two messages.
    least_steps: usize,
    /// A disc for each hit on a wall.
    hits: Vec<CylinderPrimitive>,
}

impl Trail {
    pub fn new(maze: &Maze) -> Self {
        Self {
            unit_m: maze.cell_size_m(),
            ..Self::default()
        }
    }

    /// Starts a new trail at the robot's position.
    pub fn restart(&mut self, view: &View<'_>) {
        *self = Self::new(view.maze);
        self.step(view, &[], false);
    }

    /// Marks a wall hit. Harder hits have larger marks.
    pub fn hit(&mut self, maze: &Maze, contact: &Contact) {
        if self.hits.len() == MAX_HITS {
            return;
        }
        let at = maze.point_in_grid(contact.point_in_map);
        let share = (contact.impulse_ns / HARD_N_S).clamp(0.3, 1.0);
        let wide = 0.36 * self.unit_m * share;
        let (pose, high) = (place(at.x, at.y, 0.26 * self.unit_m), 0.02 * self.unit_m);
        let size = vector(wide, wide, high);
        self.hits.push(cylinder(pose, size, 1.0, color(HIT, 0.9)));
    }

    /// Continues along these poses to the robot's position.
    pub fn step(&mut self, view: &View<'_>, poses: &[Pose], explored: bool) {
        self.steps += 1;
        self.least_steps = view.wheels_mps.map_or(1, |_| WHEEL_STEPS);
        self.drive(view.maze, poses, explored);
        let (from, to) = (self.at, view.cell);
        let number = self.visit(view);
        self.at = Some(to);
        let Some(from) = from.filter(|&from| from != to && are_adjacent(from, to)) else {
            return;
        };
        let Some(&before) = self.visited.get(&view.maze.index(from)) else {
            return;
        };
        let mut border = [from, to].map(|cell| view.maze.index(cell));
        border.sort_unstable();
        if self.crossed.insert(border) {
            self.lines.extend([before, number]);
        }
    }

    /// Adds the trajectory between poses.
    fn drive(&mut self, maze: &Maze, poses: &[Pose], explored: bool) {
        let mut driven_m = 0.0;
        for pair in poses.windows(2) {
            let [from, to] = [0, 1]
                .map(|at| maze.point_in_grid(pair[at].robot_in_map.translation.vector.into()));
            let length_m = (to - from).norm();
            if length_m < 0.01 * self.unit_m {
                continue;
            }
            let seconds = (pair[1].time_ns - pair[0].time_ns) as f64 / 1e9;
            let share = length_m / seconds.max(1e-3) / (FAST * self.unit_m);
            let shade = ((share * SPEEDS.len() as f64) as usize).min(SPEEDS.len() - 1);
            let dash_m = if explored {
                DASH * self.unit_m
            } else {
                f64::MAX
            };
            for [begin, end] in dashes(driven_m, length_m, dash_m) {
                let ends = [begin, end].map(|at| from + (to - from) * (at / length_m));
                self.add_piece(shade, ends);
            }
            driven_m += length_m;
        }
        let surplus = self.pieces.len().saturating_sub(MAX_PIECES);
        self.is_cut |= surplus > 0;
        self.pieces.drain(..surplus);
    }

    /// Adds a piece, or extends the last one if both form a straight line.
    fn add_piece(&mut self, shade: usize, ends: [Point2<f64>; 2]) {
        let [from, to] = ends.map(|at| self.on_grid(at));
        let off_m = MAX_OFFSET * self.unit_m;
        match self.pieces.back_mut() {
            Some((before, [begin, end]))
                if *before == shade && *end == from && is_between(&from, [begin, &to], off_m) =>
            {
                *end = to;
            }
            _ => self.pieces.push_back((shade, [from, to])),
        }
    }

    fn on_grid(&self, at: Point2<f64>) -> Point3 {
        let grid_m = FINENESS * self.unit_m;
        let on_grid = |along_m: f64| (along_m / grid_m).round() * grid_m;
        point(Point2::new(on_grid(at.x), on_grid(at.y)), 0.0)
    }

    /// Returns the number of a cell's point, and adds the point on the first visit.
    fn visit(&mut self, view: &View<'_>) -> u32 {
        let at = view.now().robot_in_map.translation.vector;
        let at = view.maze.point_in_grid(at.into());
        let cell = view.maze.index(view.cell);
        *self.visited.entry(cell).or_insert_with(|| {
            self.points.push(point(at, 0.0));
            self.points.len() as u32 - 1
        })
    }

    /// Returns true if the trail should be written after the last step.
    pub fn is_due(&self) -> bool {
        let interval = (self.lines.len() / 2 / SHORT + 1).next_power_of_two();
        self.steps.is_multiple_of(interval * self.least_steps)
    }

    /// Returns the trail as a scene.
    pub fn scene(&self, time_ns: u64) -> SceneUpdate {
        let mut trail = entity("trail", GRID, time_ns);
        if self.is_cut && !self.lines.is_empty() {
            trail.lines.push(LinePrimitive {
                indices: self.lines.clone(),
                ..self.line([0.04, 0.03], self.points.clone())
            });
        }
        if !self.pieces.is_empty() {
            let (points, colors, indices) = joined(self.pieces.iter().copied());
            trail.lines.push(LinePrimitive {
                colors,
                indices,
                ..self.line([0.055, 0.035], points)
            });
        }
        let mut hits = entity("hits", GRID, time_ns);
        hits.cylinders.clone_from(&self.hits);
        update(vec![trail, hits])
    }

    /// Creates lines between pairs of points; thickness and height above the floor are in cells.
    fn line(&self, [thick, high]: [f64; 2], points: Vec<Point3>) -> LinePrimitive {
        let pose = place(0.0, 0.0, high * self.unit_m);
        lines(pose, thick * self.unit_m, points, color(SPEEDS[1], 1.0))
    }
}

/// Returns true if a point lies between two others, at most `off_m` beside the line.
fn is_between(at: &Point3, [from, to]: [&Point3; 2], off_m: f64) -> bool {
    let whole = Vector2::new(to.x - from.x, to.y - from.y);
    let part = Vector2::new(at.x - from.x, at.y - from.y);
    let length_m = whole.norm();
    let along_m = part.dot(&whole) / length_m;
    (0.0..=length_m).contains(&along_m) && part.perp(&whole).abs() <= off_m * length_m
}

/// Converts pieces to points with colours, and two point numbers for each piece. Consecutive pieces
/// share a point.
fn joined(
    pieces: impl Iterator<Item = (usize, [Point3; 2])>,
) -> (Vec<Point3>, Vec<Color>, Vec<u32>) {
    let (mut points, mut colors, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    for (shade, [from, to]) in pieces {
        let rgb = color(SPEEDS[shade], 1.0);
        if points.last() != Some(&from) {
            points.push(from);
            colors.push(rgb);
        }
        points.push(to);
        colors.push(rgb);
        let end = points.len() as u32 - 1;
        numbers.extend([end - 1, end]);
    }
    (points, colors, numbers)
}

/// Returns the drawn parts of a segment of this length that begins after `driven_m` metres.
fn dashes(driven_m: f64, length_m: f64, dash_m: f64) -> Vec<[f64; 2]> {
    let mut parts = Vec::new();
    let mut number = (driven_m / dash_m).floor();
    loop {
        let begin = (number * dash_m - driven_m).max(0.0);
        if begin >= length_m {
            return parts;
        }
        let end = ((number + 1.0) * dash_m - driven_m).min(length_m);
        if number % 2.0 == 0.0 && end > begin {
            parts.push([begin, end]);
        }
        number += 1.0;
    }
}

/// Returns true if two cells touch. In a maze with joined edges, neighbours need not touch.
fn are_adjacent(a: Cell, b: Cell) -> bool {
    a.col.abs_diff(b.col) <= 1 && a.row.abs_diff(b.row) <= 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exploratory_moves_are_dashed_evenly_and_others_are_solid() {
        assert_eq!(dashes(0.5, 2.0, f64::MAX), [[0.0, 2.0]]);
        assert_eq!(dashes(0.0, 2.5, 0.5), [[0.0, 0.5], [1.0, 1.5], [2.0, 2.5]]);
        // A dash continues across two segments.
        assert_eq!(dashes(0.25, 1.0, 0.5), [[0.0, 0.25], [0.75, 1.0]]);
        assert_eq!(dashes(0.75, 0.125, 0.5), [[0.0; 2]; 0]);
    }

    #[test]
    fn consecutive_pieces_share_a_point_and_others_do_not() {
        let at = |x: f64| point(Point2::new(x, 0.0), 0.0);
        let pieces = [(0, [0.0, 1.0]), (1, [1.0, 2.0]), (2, [4.0, 5.0])];
        let pieces = pieces.map(|(shade, ends)| (shade, ends.map(at)));
        let (points, colors, numbers) = joined(pieces.into_iter());
        assert_eq!(points, [0.0, 1.0, 2.0, 4.0, 5.0].map(at));
        assert_eq!(
            colors,
            [0, 0, 1, 2, 2].map(|shade| color(SPEEDS[shade], 1.0))
        );
        assert_eq!(numbers, [0, 1, 1, 2, 3, 4]);
    }

    #[test]
    fn a_point_is_between_two_others_if_it_is_close_to_their_line() {
        let at = |x: f64, y: f64| point(Point2::new(x, y), 0.0);
        let between = |middle| is_between(&middle, [&at(0.0, 0.0), &at(4.0, 0.0)], 0.125);
        assert!(between(at(1.0, 0.0)) && between(at(3.0, -0.125)));
        assert!(!between(at(1.0, 0.25)) && !between(at(5.0, 0.0)) && !between(at(-1.0, 0.0)));
        // A turn back to the start has length 0.
        assert!(!is_between(&at(1.0, 0.0), [&at(2.0, 0.0); 2], 0.125));
    }
}
