//! `/scene/trail`: the way that the robot took in this episode, and where it hit a wall.

use std::collections::{BTreeMap, BTreeSet};

use foxglove::messages::{CylinderPrimitive, LinePrimitive, Point3, SceneUpdate, line_primitive};

use super::scene::{WORLD, color, entity, place, point, update, vector};
use crate::arena::{Contact, Sample, View};
use crate::world::{Cell, Maze};

const INK: u32 = 0xa43df0;
const HIT: u32 = 0xe0322f;
/// An impulse whose mark is as large as any, in N s: that of a robot at full speed.
const HARD_NS: f64 = 8.0;
/// Marks of an episode; later hits are told by the other topics only.
const MOST_HITS: usize = 64;
/// Up to this many lines the trail is written after each step, above that more and more rarely:
/// a long way must not fill the disk with copies of itself.
const SHORT: usize = 128;

/// The way so far: a point for each cell that was visited, where the robot first stood in it, and
/// a line for each border that was crossed. It grows with the maze, not with the steps.
#[derive(Debug)]
pub(in crate::record) struct Trail {
    /// By cell index: the number of its point.
    visited: BTreeMap<usize, u32>,
    points: Vec<Point3>,
    /// The borders that were crossed, by cell index and direction.
    crossed: BTreeSet<usize>,
    /// Two point numbers for each line.
    lines: Vec<u32>,
    unit_m: f64,
    at: Option<Cell>,
    steps: usize,
    /// A disc for each hit on a wall.
    hits: Vec<CylinderPrimitive>,
}

impl Trail {
    pub fn new(maze: &Maze) -> Self {
        Self {
            visited: BTreeMap::new(),
            points: Vec::new(),
            crossed: BTreeSet::new(),
            lines: Vec::new(),
            unit_m: maze.cell_size_m(),
            at: None,
            steps: 0,
            hits: Vec::new(),
        }
    }

    /// Starts anew where the robot stands.
    pub fn restart(&mut self, view: &View<'_>) {
        self.visited.clear();
        self.crossed.clear();
        self.points.clear();
        self.lines.clear();
        self.hits.clear();
        self.steps = 0;
        self.at = None;
        self.step(view);
    }

    /// Marks where the robot hit a wall, the larger the harder.
    pub fn hit(&mut self, contact: &Contact) {
        if self.hits.len() == MOST_HITS {
            return;
        }
        let at = contact.point_in_world;
        let share = (contact.impulse_ns / HARD_NS).clamp(0.3, 1.0);
        let wide = 0.3 * self.unit_m * share;
        self.hits.push(CylinderPrimitive {
            pose: place(at.x, at.y, 0.26 * self.unit_m),
            size: Some(vector(wide, wide, 0.02 * self.unit_m)),
            bottom_scale: 1.0,
            top_scale: 1.0,
            color: color(HIT, 0.9),
        });
    }

    /// Goes on to where the robot stands.
    pub fn step(&mut self, view: &View<'_>) {
        self.steps += 1;
        let (from, to) = (self.at, view.cell);
        let number = self.visit(view.maze.index(to), &view.now());
        self.at = Some(to);
        let Some(from) = from.filter(|&from| from != to && beside(from, to)) else {
            return;
        };
        let Some(&before) = self.visited.get(&view.maze.index(from)) else {
            return;
        };
        let border = border(view.maze, from, to);
        if self.crossed.insert(border) {
            self.lines.extend([before, number]);
        }
    }

    /// The number of a cell's point, which is made if this is the first visit.
    fn visit(&mut self, cell: usize, sample: &Sample) -> u32 {
        *self.visited.entry(cell).or_insert_with(|| {
            let at = sample.robot_in_world.translation.vector.into();
            self.points.push(point(at, 0.03 * self.unit_m));
            self.points.len() as u32 - 1
        })
    }

    /// Should the trail be written now?
    pub fn is_due(&self) -> bool {
        let rarely = (self.lines.len() / 2 / SHORT + 1).next_power_of_two();
        self.steps.is_multiple_of(rarely)
    }

    /// The trail as a scene.
    pub fn scene(&self, time_ns: u64) -> SceneUpdate {
        let mut trail = entity("trail", WORLD, time_ns);
        if !self.lines.is_empty() {
            trail.lines = vec![LinePrimitive {
                r#type: line_primitive::Type::LineList as i32,
                pose: place(0.0, 0.0, 0.0),
                thickness: super::rounded(0.07 * self.unit_m),
                scale_invariant: false,
                points: self.points.clone(),
                color: color(INK, 1.0),
                colors: Vec::new(),
                indices: self.lines.clone(),
            }];
        }
        let mut hits = entity("hits", WORLD, time_ns);
        hits.cylinders.clone_from(&self.hits);
        update(vec![trail, hits])
    }
}

/// Do two cells touch? In a maze whose edges join they need not.
fn beside(a: Cell, b: Cell) -> bool {
    a.col.abs_diff(b.col) <= 1 && a.row.abs_diff(b.row) <= 1
}

/// The number of the border (or corner) between two cells that touch, from either side.
fn border(maze: &Maze, a: Cell, b: Cell) -> usize {
    let (first, second) = if (a.row, a.col) < (b.row, b.col) {
        (a, b)
    } else {
        (b, a)
    };
    let kind = match (
        second.row - first.row,
        i32::from(second.col) - i32::from(first.col),
    ) {
        (0, _) => 0,
        (_, -1) => 1,
        (_, 0) => 2,
        _ => 3,
    };
    4 * maze.index(first) + kind
}
