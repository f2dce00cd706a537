//! The maze as sensors see it.

use nalgebra::{Isometry2, Vector2};
use xcscr_sensing::Terrain;

use crate::world::Maze;

impl Terrain for Maze {
    fn pixel_m(&self) -> f64 {
        self.everything_solid().pixel_m()
    }

    fn corner_in_grid(&self) -> Option<&Isometry2<f64>> {
        self.everything_solid().corner_in_grid()
    }

    fn is_solid(&self, col: i32, row: i32) -> bool {
        self.everything_solid().is_solid(col, row)
    }

    fn clear_m(&self, col: i32, row: i32) -> f64 {
        self.everything_solid().clear_m(col, row)
    }

    fn is_marked(&self, point_m: Vector2<f64>) -> bool {
        self.cell_in_grid(point_m.into())
            .is_some_and(|cell| self.is_goal(cell))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::StreamName;
    use crate::world::{Block, Cell};
    use parry2d::math::{Pose, Vector};
    use parry2d::query::{Ray, RayCast};
    use parry2d::shape::{Compound, SharedShape};
    use xcs::random::Stream;
    use xcscr_sensing::cast;

    const ROWS: [&str; 7] = [
        "#########",
        "#S..#...#",
        "#.#...#.#",
        "#...#.#.#",
        "#.#..#..#",
        "#..#...G#",
        "#########",
    ];

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    /// Returns the same walls as shapes of parry2d, in single precision.
    fn oracle(maze: &Maze) -> Compound {
        let shape = |block: &Block| {
            let [width, height] = maze.solid().size_of(block).map(|length| length as f32);
            let middle = maze.solid().middle_of(block);
            (
                Pose::from_translation(Vector::new(middle.x as f32, middle.y as f32)),
                SharedShape::cuboid(width / 2.0, height / 2.0),
            )
        };
        let blocks = maze.solid().blocks();
        Compound::new(blocks.iter().map(shape).collect())
    }

    #[test]
    fn rays_are_as_long_as_with_parry() {
        let (maze, mut random) = (maze(), Stream::new(1, StreamName::Start));
        let oracle = oracle(&maze);
        let free: Vec<Cell> = maze.free_cells().collect();
        let (mut worst, mut hits) = (0.0_f64, 0);
        for number in 0..20_000 {
            let cell = free[random.below(free.len())];
            // Single precision represents these numbers exactly, so that both sides cast the same
            // ray.
            let offset =
                |random: &mut Stream| 0.1 + random.below(1 << 12) as f64 / f64::from(1 << 12) * 0.8;
            let (east, north) = (offset(&mut random), offset(&mut random));
            let origin = Vector2::new(
                f64::from(cell.col) + east,
                f64::from(maze.height() - cell.row) - north,
            );
            let angle = random.unit() * std::f64::consts::TAU;
            let direction = Vector2::new(libm::cos(angle), libm::sin(angle));
            let ray = Ray::new(
                Vector::new(origin.x as f32, origin.y as f32),
                Vector::new(direction.x as f32, direction.y as f32),
            );
            let theirs = oracle.cast_local_ray(&ray, 20.0, true).map(f64::from);
            let ours = cast(&maze, origin, direction, 20.0);
            let (Some(theirs), Some(ours)) = (theirs, ours) else {
                panic!(
                    "ray {number} from {origin:?} along {direction:?}: {ours:?}, parry {theirs:?}"
                );
            };
            hits += 1;
            let difference = (ours - theirs).abs();
            // Near a corner, single precision may hit either wall.
            assert!(
                difference < 1e-4 || is_near_corner(origin + ours.min(theirs) * direction),
                "ray {number} from {origin:?} along {direction:?}: {ours}, parry {theirs}"
            );
            worst = worst.max(if difference < 1e-4 { difference } else { 0.0 });
        }
        assert!(hits == 20_000 && worst < 2e-5, "{hits} hits, worst {worst}");
    }

    fn is_near_corner(point: Vector2<f64>) -> bool {
        let off = |x: f64| (x - x.round()).abs() < 1e-4;
        off(point.x) && off(point.y)
    }

    #[test]
    fn rays_match_a_calculation_by_hand() {
        let (maze, middle) = (maze(), Vector2::new(1.5, 5.5));
        let diagonal = Vector2::new(0.6, -0.8);
        assert_eq!(cast(&maze, middle, Vector2::x(), 8.0), Some(2.5));
        assert_eq!(cast(&maze, middle, -Vector2::y(), 8.0), Some(4.5));
        // Leaves the start cell through its south side at (1.875, 5), and meets the wall at x = 2.
        assert!((cast(&maze, middle, diagonal, 8.0).unwrap() - 0.5 / 0.6).abs() < 1e-12);
    }

    #[test]
    fn a_wall_beyond_the_limit_is_not_hit() {
        let (maze, middle) = (maze(), Vector2::new(1.5, 5.5));
        assert_eq!(cast(&maze, middle, Vector2::x(), 2.4), None);
        assert_eq!(cast(&maze, middle, Vector2::new(f64::NAN, 0.0), 2.4), None);
    }
}
