//! `/scene/trail`: the robot's trajectory in this episode, and the wall hits.

use foxglove::messages::{CylinderPrimitive, LinePrimitive, Point3, SceneUpdate};
use nalgebra::Point2;

use super::scene::{GRID, color, cylinder, entity, lines, place, point, update, vector};
use crate::event::{Contact, Pose};
use xcscr_robot::world::Maze;

const HIT: u32 = 0xe0322f;
const PATH: u32 = 0xa82bd0;
/// The maximum number of points. Earlier ones are not shown.
const MAX_POINTS: usize = 4096;
/// The trail is not drawn across the edges of a maze whose edges are joined. The longest distance
/// between two points, in cells.
const LONGEST: f64 = 1.6;
/// The impulse with the largest mark, in N s: that of a robot at full speed.
const HARD_N_S: f64 = 8.0;
/// The maximum number of marks per episode. Later hits are on the other topics only.
const MAX_HITS: usize = 64;
/// Up to this many points the trail is written after each step, and above that less and less often.
/// This keeps the copies of a long trail from filling the disk.
const SHORT: usize = 1024;
/// The least time between two messages. A step of an agent that sets the speeds of the wheels has 50 ms.
const PERIOD_NS: u64 = 500_000_000;

/// The trajectory so far.
#[derive(Debug, Default)]
pub(crate) struct Trail {
    points: Vec<Point3>,
    unit_m: f64,
    steps: usize,
    /// The time of the last message, in nanoseconds.
    shown_ns: u64,
    /// A disc for each hit on a wall.
    hits: Vec<CylinderPrimitive>,
}

impl Trail {
    /// Starts a trail.
    pub fn new(maze: &Maze) -> Self {
        Self {
            unit_m: maze.cell_size_m(),
            ..Self::default()
        }
    }

    /// Continues to a pose.
    pub fn follow(&mut self, maze: &Maze, pose: &Pose) {
        let at = maze.point_in_grid(pose.robot_in_map.translation.vector.into());
        let at = point(at, 0.0);
        if self.points.last() != Some(&at) {
            self.points.push(at);
        }
        if self.points.len() > MAX_POINTS {
            self.points.drain(..MAX_POINTS / 4);
        }
    }

    /// Marks a wall hit. Harder hits have larger marks.
    pub fn hit(&mut self, maze: &Maze, contact: &Contact) {
        let Some((x, y)) = contact.x_m.zip(contact.y_m) else {
            return;
        };
        if self.hits.len() == MAX_HITS {
            return;
        }
        let at = maze.point_in_grid(Point2::new(x, y));
        let share = (contact.impulse_n_s.unwrap_or(0.0) / HARD_N_S).clamp(0.3, 1.0);
        let wide = 0.36 * self.unit_m * share;
        let (pose, high) = (place(at.x, at.y, 0.26 * self.unit_m), 0.02 * self.unit_m);
        let size = vector(wide, wide, high);
        self.hits.push(cylinder(pose, size, 1.0, color(HIT, 0.9)));
    }

    /// Counts a step, and returns true if the trail should be written after it.
    pub fn is_due(&mut self, time_ns: u64) -> bool {
        self.steps += 1;
        let interval = (self.points.len() / SHORT + 1).next_power_of_two();
        let is_late = time_ns >= self.shown_ns + PERIOD_NS;
        is_late && self.steps.is_multiple_of(interval)
    }

    /// Returns the trail as a scene.
    pub fn scene(&mut self, time_ns: u64) -> SceneUpdate {
        self.shown_ns = time_ns;
        let mut trail = entity("trail", GRID, time_ns);
        let pieces = self.points.windows(2).enumerate();
        let near = pieces.filter(|(_, ends)| self.are_near(&ends[0], &ends[1]));
        let indices: Vec<u32> = near
            .flat_map(|(at, _)| [at as u32, at as u32 + 1])
            .collect();
        if !indices.is_empty() {
            let pose = place(0.0, 0.0, 0.035 * self.unit_m);
            let thick_m = 0.055 * self.unit_m;
            trail.lines = vec![LinePrimitive {
                indices,
                ..lines(pose, thick_m, self.points.clone(), color(PATH, 1.0))
            }];
        }
        let mut hits = entity("hits", GRID, time_ns);
        hits.cylinders.clone_from(&self.hits);
        update(vec![trail, hits])
    }

    fn are_near(&self, a: &Point3, b: &Point3) -> bool {
        (a.x - b.x).hypot(a.y - b.y) <= LONGEST * self.unit_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry2, Vector2};

    #[test]
    fn a_trail_is_not_drawn_across_joined_edges() {
        let rows = br########"{ "rows": ["#######", "#S...G#", "#######"] }"########;
        let maze = Maze::from_json(rows, "rows").unwrap();
        let mut trail = Trail::new(&maze);
        for x in [1.5, 2.5, 5.5, 4.5] {
            let pose = Pose {
                time_ns: 0,
                robot_in_map: Isometry2::new(Vector2::new(x, 1.5), 0.0),
                robot_in_odom: Isometry2::identity(),
                estimate: None,
                velocity_mps: Vector2::zeros(),
                turn_radps: 0.0,
            };
            trail.follow(&maze, &pose);
        }
        let scene = trail.scene(0);
        assert_eq!(scene.entities[0].lines[0].indices, [0, 1, 2, 3]);
    }
}
