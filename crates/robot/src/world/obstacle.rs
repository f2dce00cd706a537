//! Obstacles that the map of a robot does not have.

use std::sync::Arc;

use super::maze::{Cell, Maze};
use super::solid::Solid;

impl Maze {
    /// Returns the shape of everything solid: the walls, and obstacles that are not in the map.
    pub(crate) fn everything_solid(&self) -> &Arc<Solid> {
        self.obstructed.as_ref().unwrap_or(&self.solid)
    }

    /// Returns the same world with a square box in the middle of a cell. The box is not in the map
    /// of the robot. Returns `None` in a maze, and if the box leaves no way from the start to a
    /// goal, or stands where the robot starts.
    pub fn with_box(&self, cell: Cell, side_m: f64) -> Option<Self> {
        let radius_m = self.clear_radius_m()?;
        let solid = self.solid.with_box(self.centre_in_grid(cell), side_m);
        let is_clear = |cell| solid.is_clear(self.centre_in_grid(cell), radius_m);
        if !self
            .start
            .into_iter()
            .chain(self.goals.iter().copied())
            .all(is_clear)
        {
            return None;
        }
        self.with_solid(solid.clone())?;
        Some(Self {
            obstructed: Some(Arc::new(solid)),
            ..self.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::{Agreement, PhysicsParams};
    use crate::sensor::Sensor;

    /// A hall of 7 x 5 cells of 0.5 m. Its walls are on no line of the grid: pixels of 0.05 m.
    fn hall() -> Maze {
        let [width, height] = [70, 50];
        let is_wall = |at: usize| {
            let (col, row) = (at % width, at / width);
            !(6..=62).contains(&col) || !(7..=44).contains(&row) || (col == 30 && row < 24)
        };
        let row = |row: usize| {
            let letters = (0..width).map(|col| {
                if is_wall(row * width + col) {
                    "1#"
                } else {
                    "1."
                }
            });
            letters.collect::<String>()
        };
        let rows: Vec<String> = (0..height).map(row).collect();
        let world = serde_json::json!({
            "cell_size_m": 0.5,
            "rows": ["#######", "#S...G#", "#.....#", "#.....#", "#######"],
            "solid": { "pixel_m": 0.05, "corner": [0.0, 0.0, 0.0], "radius_m": 0.12, "rows": rows },
        });
        Maze::from_json(world.to_string().as_bytes(), "hall.json").unwrap()
    }

    fn burger() -> PhysicsParams {
        PhysicsParams {
            radius_m: 0.105,
            wheel_base_m: 0.16,
            max_speed_mps: 0.22,
            arrival_m: 0.015,
            ..PhysicsParams::default()
        }
    }

    #[test]
    fn a_box_is_solid_for_the_robot_and_not_in_its_map() {
        let hall = hall();
        let cell = Cell { col: 2, row: 2 };
        let boxed = hall.with_box(cell, 0.4).unwrap();
        let at = hall.centre_in_grid(cell);
        assert!(boxed.everything_solid().is_solid_at(at) && !boxed.solid().is_solid_at(at));
        assert!(
            !boxed.is_wall(cell)
                && boxed.step(Cell { col: 1, row: 2 }, crate::world::Direction::MAIN[1])
                    == Some(cell)
        );
        let added = |maze: &Maze| {
            maze.everything_solid()
                .bits
                .iter()
                .filter(|&&bit| bit)
                .count()
        };
        assert_eq!(added(&boxed) - added(&hall), 64);
        assert!(
            hall.with_box(Cell { col: 1, row: 1 }, 0.4).is_none(),
            "on the start"
        );
        assert!(hall.with_box(cell, 3.0).is_none(), "no way is left");
    }

    /// The feature that is off: a robot that believes that walls fill the cells of a grid.
    #[test]
    fn control_a_robot_that_believes_in_blocks_has_wrong_percepts_among_the_pixels() {
        let hall = hall();
        let wrong = |maze: &Maze| {
            let found = Agreement::measure(maze, &burger(), Sensor::Lidar).unwrap();
            f64::from(found.wrong_percepts) / f64::from(found.places)
        };
        assert_eq!(wrong(&hall), 0.0);
        let blocks = Maze {
            solid: Maze::solid_cells(&hall.walls, hall.width, hall.cell_size_m),
            obstructed: Some(Arc::clone(&hall.solid)),
            open: None,
            ..hall
        };
        assert!(wrong(&blocks) > 0.3, "{}", wrong(&blocks));
    }
}
