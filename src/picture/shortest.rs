//! The optimal paths of a world (Figure 3 of the paper).

use super::colours::{css, shade};
use super::drawing::{Plane, arrow};
use super::svg::{Element, short};
use crate::world::{Cell, Direction, Maze, Moves, Paths};
use xcs::Action;

/// A colour for each path, which colour-blind people can distinguish (Okabe and Ito 2008).
const PATHS: [u32; 6] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x5a5a5a];
/// The distance of neighbouring paths, in cells.
const BETWEEN: f64 = 0.13;

impl Plane<'_> {
    /// Returns the shortest paths from the start, side by side. Where there are too many to tell apart, or episodes
    /// start anywhere, returns the optimal actions of all cells.
    pub fn optimal_paths(&self) -> Vec<Element> {
        let paths = Paths::new(self.maze);
        match few_paths(self.maze, &paths) {
            Some(few) => {
                let middle = (few.len() - 1) as f64 / 2.0;
                let numbered = few.iter().zip(PATHS).enumerate();
                let path = |(number, (path, colour)): (usize, (&Vec<Step>, u32))| {
                    self.path(path, BETWEEN * (number as f64 - middle), colour)
                };
                numbered.flat_map(path).collect()
            }
            None => self.optimal_actions(&paths),
        }
    }

    /// Returns a path, moved sideways by `shift` cells: a line, and an arrow on each step.
    fn path(&self, steps: &[Step], shift: f64, colour: u32) -> Vec<Element> {
        // The shift is along no direction of a step, so that parallel paths never overlap.
        let down = match self.maze.moves() {
            Moves::Four => shift,
            Moves::Eight => 0.5 * shift,
        };
        let at = |cell| {
            let (x, y) = self.centre(cell);
            (x + shift * self.cell, y + down * self.cell)
        };
        let ends = steps.iter().map(|step| step.to);
        let cells = steps.first().map(|step| step.from).into_iter().chain(ends);
        let points = cells.map(|cell| {
            let (x, y) = at(cell);
            format!("{},{}", short(x), short(y))
        });
        let line = Element::new(
            "polyline",
            [
                ("points", points.collect::<Vec<_>>().join(" ")),
                ("fill", "none".to_owned()),
                ("stroke", css(colour)),
                ("stroke-width", short(0.05 * self.cell)),
                ("stroke-linejoin", "round".to_owned()),
            ],
        );
        let head = |step: &Step| {
            let ((x, y), (to_x, to_y)) = (at(step.from), at(step.to));
            // The tail of the arrow, so that its head is behind the middle of the step.
            let tail = (x + 0.36 * (to_x - x), y + 0.36 * (to_y - y));
            arrow(tail, step.along, 0.34 * self.cell, colour)
        };
        [line].into_iter().chain(steps.iter().map(head)).collect()
    }

    /// Returns an arrow for each action that begins a shortest path to a goal, coloured by the distance.
    fn optimal_actions(&self, paths: &Paths) -> Vec<Element> {
        let maze = self.maze;
        let distances = maze
            .free_cells()
            .filter_map(|cell| paths.distance(maze, cell));
        let farthest = f64::from(distances.max().unwrap_or(1).max(2) - 1);
        let cells = maze.free_cells().filter(|&cell| !maze.is_goal(cell));
        let steps = cells.flat_map(|cell| optimal_steps(maze, paths, cell));
        let shape = |step: Step| {
            let left = paths.distance(maze, step.to).map_or(0.0, f64::from);
            let fill = shade(1.0 - left / farthest);
            arrow(self.centre(step.from), step.along, 0.47 * self.cell, fill)
        };
        steps.map(shape).collect()
    }
}

/// A step on a shortest path.
#[derive(Debug, Clone, Copy)]
struct Step {
    from: Cell,
    along: Direction,
    to: Cell,
}

/// Returns the steps from a cell that begin a shortest path.
fn optimal_steps<'a>(
    maze: &'a Maze,
    paths: &'a Paths,
    from: Cell,
) -> impl Iterator<Item = Step> + 'a {
    Action::all(maze.action_count()).filter_map(move |action| {
        let to = paths.successor(maze, from, action)?;
        let along = maze.direction(action)?;
        Some(Step { from, along, to })
    })
}

/// Returns all shortest paths from the start, if there are few. Returns none if episodes start anywhere, or if a line
/// may leave the picture at one edge and enter it at another.
fn few_paths(maze: &Maze, paths: &Paths) -> Option<Vec<Vec<Step>>> {
    let start = maze.start().filter(|_| !maze.wraps())?;
    let count = paths.count_from(maze, start);
    if !(1..=PATHS.len() as u64).contains(&count) {
        return None;
    }
    let mut open: Vec<Vec<Step>> = optimal_steps(maze, paths, start)
        .map(|step| vec![step])
        .collect();
    let mut complete = Vec::new();
    while let Some(path) = open.pop() {
        match path.last() {
            Some(step) if !maze.is_goal(step.to) => {
                let onward = optimal_steps(maze, paths, step.to);
                open.extend(onward.map(|step| [&path[..], &[step]].concat()));
            }
            _ => complete.push(path),
        }
    }
    Some(complete)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths_of(name: &str) -> Option<Vec<Vec<Step>>> {
        let maze = Maze::load(format!("worlds/{name}.json").as_ref()).unwrap();
        few_paths(&maze, &Paths::new(&maze))
    }

    #[test]
    fn the_paths_of_the_paper_s_mazes_are_those_of_its_figure_3() {
        // Figure 3 and Section I: three paths of ten steps in Maze4; two paths in Maze6.
        for (name, count, steps) in [("maze4", 3, 10), ("maze5", 1, 12), ("maze6", 2, 12)] {
            let paths = paths_of(name).unwrap();
            assert_eq!(paths.len(), count, "{name}");
            let mut routes: Vec<Vec<(u16, u16)>> = Vec::new();
            for path in &paths {
                assert_eq!(path.len(), steps, "{name}");
                assert!(path.windows(2).all(|two| two[0].to == two[1].from));
                routes.push(path.iter().map(|step| (step.to.col, step.to.row)).collect());
            }
            routes.sort_unstable();
            routes.dedup();
            assert_eq!(routes.len(), count, "{name}: each path is drawn once");
        }
    }

    #[test]
    fn control_a_world_with_random_starts_has_no_such_paths() {
        assert!(paths_of("maze4-classic").is_none());
    }
}
