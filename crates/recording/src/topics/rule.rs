//! `/scene/rule`: why an action was selected, as text above the robot, from the decision on.

use foxglove::messages::SceneUpdate;

use super::scene::{ROBOT, entity, label, place, update};
use crate::event::Decision;
use xcscr_robot::world::Maze;

/// Colours of actions selected by rules or a table, and of exploratory ones.
const CHOSEN: u32 = 0xffffff;
const EXPLORED: u32 = 0xf4b740;
/// The number of letters per line above the robot, and the maximum number of lines with demands.
const LETTERS: usize = 26;
const LINES: usize = 2;
/// The letter height, as a share of a cell and of the longer side of the maze; the larger one
/// applies.
const LETTER: [f64; 2] = [0.23, 0.028];
/// The height of the lowest line above the floor and the line spacing, in letters.
const FIRST: f64 = 3.6;
const NEXT: f64 = 2.5;
/// The visible share of an upright object's height, because the camera looks down steeply.
const SEEN_UPRIGHT: f64 = 0.9;
/// Creates the scene with the reasons of a decision as text above the robot, legible from everywhere.
pub(crate) fn scene(decision: &Decision, maze: &Maze, time_ns: u64) -> SceneUpdate {
    let height = letter_m(maze);
    let rgb = if decision.explored { EXPLORED } else { CHOSEN };
    let lines = abbreviated(&decision.because).into_iter().rev();
    let lines = [format!("-> {}", decision.choice)].into_iter().chain(lines);
    let mut words = entity("rule", ROBOT, time_ns);
    // The camera looks down steeply, so upright text appears a little lower.
    let upwards = (0..).map(|line| (FIRST + NEXT * f64::from(line)) * height);
    words.texts = lines
        .zip(upwards)
        .map(|(line, up)| label(place(0.0, 0.0, up), height, rgb, &line))
        .collect();
    update(vec![words])
}

/// Returns how far the text above a robot in the northernmost free cells extends north of the maze
/// in the camera's view, in metres.
pub(super) fn reach_m(maze: &Maze) -> f64 {
    let top = (FIRST + NEXT * LINES as f64 + 0.5) * letter_m(maze);
    (SEEN_UPRIGHT * top - 1.5 * maze.cell_size_m()).max(0.0)
}

/// Returns the height of a letter, in metres.
fn letter_m(maze: &Maze) -> f64 {
    let side = f64::from(maze.width().max(maze.height())) * maze.cell_size_m();
    (LETTER[0] * maze.cell_size_m()).max(LETTER[1] * side)
}

/// Returns as many demands as fit above the robot, line by line. The least informative come last.
fn abbreviated(demands: &[String]) -> Vec<String> {
    let demands = demands.iter();
    let (weak, strong): (Vec<_>, Vec<_>) = demands.partition(|demand| demand.ends_with("no goal"));
    let mut lines = vec![String::new()];
    for demand in strong.into_iter().chain(weak) {
        let has_room = lines
            .last()
            .is_some_and(|line| line.len() + demand.len() <= LETTERS);
        let is_full = lines.len() == LINES;
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.clone_from(demand),
            Some(line) if has_room => *line = format!("{line}, {demand}"),
            Some(line) if is_full => {
                line.push_str(", ...");
                break;
            }
            _ => lines.push(demand.clone()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_above_the_robot_is_short_and_begins_with_the_most_informative_demand() {
        let abbreviated = |demands: &[&str]| {
            abbreviated(
                &demands
                    .iter()
                    .map(|&one| one.to_owned())
                    .collect::<Vec<_>>(),
            )
        };
        assert_eq!(
            abbreviated(&["north no goal", "east free"]),
            ["east free, north no goal"]
        );
        assert_eq!(abbreviated(&["explores by chance"]), ["explores by chance"]);
        let long = [
            "north wall",
            "north-east wall",
            "east free",
            "south-east free",
            "south-west wall",
            "west wall",
        ];
        let wanted = [
            "north wall, north-east wall",
            "east free, south-east free, ...",
        ];
        assert_eq!(abbreviated(&long), wanted);
    }
}
