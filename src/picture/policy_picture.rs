//! A picture of the policy after an episode.

use super::camera::{Camera, Stages};
use super::{action_values, drawing};
use crate::agent::{Knowledge, Sharing};
use crate::episode::{Ending, Episode, Observer, PolicyMap};
use crate::trial::{Plan, steps_to_goal};
use crate::world::{Cell, Maze, Paths};
use crate::{Error, ErrorKind};

/// The most cells of a maze that is drawn. The SVG of such a maze takes 145 MB.
const MOST_CELLS: usize = 1 << 20;

/// An episode and the policy after it.
#[derive(Debug, Clone)]
pub(super) struct Moment {
    /// The stage of learning; `None` for an episode that was asked for.
    pub stage: Option<Stage>,
    /// The result of the episode.
    pub episode: Episode,
    /// The policy after the episode.
    pub policy: PolicyMap,
    /// True if the policy was globally optimal.
    pub optimal: bool,
    /// The cells of the greedy path from the start of the episode.
    pub greedy_path: Vec<Cell>,
    /// The cells visited in the episode, the start first.
    pub visited: Vec<Cell>,
}

/// A stage of learning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// The last episode before the first one that reached the goal.
    BeforeSuccess,
    /// The first episode, from the first success on, after which the greatest value was above 0 in half of the cells
    /// on shortest paths.
    HalfPositive,
    /// The last episode that reached the goal.
    LastSuccess,
}

/// By how much the optimal action is better than the best other action, after an episode. The cells are those of the
/// shortest path that the values prefer; all cells if episodes start anywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Margin {
    pub episode: u32,
    /// The mean over the cells.
    pub mean: f64,
    /// The least of all cells. If it is above 0, the greedy path is a shortest one.
    pub least: f64,
}

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// The policy after one episode.
    Policy,
    /// The value of every action, at up to three stages of learning (Figures 2 and 5 of the paper).
    ActionValues,
}

/// A picture of the policy over the maze, or of the values behind it. The same picture gives the same bytes.
#[derive(Debug, Clone)]
pub struct PolicyPicture {
    pub(super) maze: Maze,
    pub(super) title: String,
    pub(super) paths: Paths,
    pub(super) look: Look,
    /// At least one.
    pub(super) moments: Vec<Moment>,
    /// In the order of episodes; empty for a single episode.
    pub(super) margins: Vec<Margin>,
    /// How the method shares the reward of an episode among its steps, if it does.
    pub(super) sharing: Option<Sharing>,
}

impl PolicyPicture {
    /// Looks at the policy after an episode, while `watch` repeats the run of the plan for an observer, as far as
    /// needed. Without an episode, looks at the last one or, for action values, at the [stages](Stages) of learning.
    ///
    /// # Errors
    /// When the run has no such episode, when the maze has more than a million cells, and the errors of
    /// `watch`.
    pub(crate) fn of(
        plan: &Plan,
        after: Option<u32>,
        look: Look,
        watch: impl FnOnce(&mut dyn Observer) -> Result<Knowledge, Error>,
    ) -> Result<Self, Error> {
        check_size(
            &plan.maze,
            "; `xcscr rules RUN --why COL,ROW` shows what was learned in one cell",
        )?;
        let episodes = plan.config.episodes;
        let last = after.unwrap_or(episodes);
        if !(1..=episodes).contains(&last) {
            let message = format!("there is no episode {last}: the run has {episodes}");
            return Err(ErrorKind::Usage.error(message));
        }
        let stages = match (look, after) {
            (Look::ActionValues, None) => Stages::OfLearning,
            _ => Stages::After(last),
        };
        let mut camera = Camera::new(stages, plan);
        // The camera ends the run.
        watch(&mut camera)?;
        Ok(camera.picture(plan, look))
    }

    /// Renders an SVG document.
    pub fn svg(&self) -> String {
        let drawing = match self.look {
            Look::Policy => drawing::draw(self),
            Look::ActionValues => action_values::draw(self),
        };
        drawing.document()
    }
}

/// Draws a world as an SVG document (Figure 3 of the paper): its walls, the start, the goals and the shortest paths,
/// with a caption below its name. With more than six paths, or a random start, it shows the optimal actions of all
/// cells. The same world gives the same bytes.
///
/// # Errors
/// When the world has more than a million cells.
pub fn world_picture(maze: &Maze, caption: String) -> Result<String, Error> {
    check_size(maze, "")?;
    Ok(drawing::draw_world(maze, caption).document())
}

/// Rejects a maze of more than [`MOST_CELLS`] cells. The message ends with a hint.
fn check_size(maze: &Maze, hint: &str) -> Result<(), Error> {
    let cells = usize::from(maze.width()) * usize::from(maze.height());
    if cells <= MOST_CELLS {
        return Ok(());
    }
    let name = maze.name();
    Err(ErrorKind::BadData.error(format!(
        "cannot draw the picture: {name} has {cells} cells, but at most {MOST_CELLS} can be drawn{hint}"
    )))
}

impl Stage {
    /// Returns the letter of the panel, as in Figure 5 of the paper, and the name.
    pub(super) fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::BeforeSuccess => ("a", "before the first success"),
            Self::HalfPositive => ("b", "half of the shortest path positive"),
            Self::LastSuccess => ("c", "last success"),
        }
    }
}

impl Moment {
    /// The caption below the title.
    pub(super) fn caption(&self, maze: &Maze, paths: &Paths) -> String {
        let from = self.visited[0];
        let shortest = paths.distance(maze, from);
        let greedy = match steps_to_goal(&self.greedy_path, maze) {
            Some(now) if paths.slips() => format!("{now} steps when nothing slips"),
            Some(now) if Some(now) == shortest => format!("{now} steps, the fewest"),
            Some(now) => format!("{now} steps"),
            None => "never arrives".to_owned(),
        };
        // Where actions slip, the fewest steps are not a meaningful reference.
        let verdict = if paths.slips() && self.optimal {
            "; the policy is optimal"
        } else {
            ""
        };
        let result = self.result();
        format!("{result}; greedy path now: {greedy}{verdict}")
    }

    /// The number and the result of the episode.
    pub(super) fn result(&self) -> String {
        let Episode { episode, steps, .. } = self.episode;
        let how = match self.episode.ending {
            Ending::Goal => "to the goal",
            Ending::StepLimit => "and gave up",
        };
        format!("episode {episode}: {steps} steps {how}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::ArenaKind;
    use crate::trial::Trial;

    /// Returns an empty hall with a start and a goal.
    fn hall(width: usize, height: usize) -> Maze {
        let mut rows = vec![format!("#{}#", ".".repeat(width - 2)); height];
        rows[0] = "#".repeat(width);
        rows[height - 1] = rows[0].clone();
        rows[1].replace_range(1..3, "SG");
        Maze::from_json(format!(r#"{{ "rows": {rows:?} }}"#).as_bytes(), "hall").unwrap()
    }

    fn drawn(plan: Plan) -> Result<PolicyPicture, Error> {
        PolicyPicture::of(&plan, None, Look::Policy, |camera| {
            let mut trial = Trial::new(plan.clone())?;
            let _ = trial.run(camera);
            Ok(trial.method().knowledge())
        })
    }

    #[test]
    fn a_maze_of_more_than_a_million_cells_is_not_drawn_and_the_message_suggests_an_alternative() {
        let plan = Plan::new(hall(4096, 257)).episodes(1);
        let refused = drawn(plan).err();
        let refused = refused.expect("it has too many cells").to_string();
        for part in ["hall has 1052672 cells", "xcscr rules RUN --why COL,ROW"] {
            assert!(refused.contains(part), "{refused}");
        }
    }

    #[test]
    fn the_picture_of_a_world_has_its_walls_its_marks_and_its_shortest_paths() {
        let picture = |maze: &str| {
            let path = format!("worlds/{maze}.json");
            world_picture(&Maze::load(path.as_ref()).unwrap(), "caption".to_owned()).unwrap()
        };
        let picture = picture("maze4");
        for part in [
            "<title>maze4</title>",
            ">caption</text>",
            ">S</text>",
            ">G</text>",
        ] {
            assert_eq!(picture.matches(part).count(), 1, "{part}");
        }
        // Each of the 27 free cells has a frame and a tile, and the start and the goal have a third square.
        let squares = picture.matches("<rect").count();
        assert_eq!(squares, 2 + 2 * 27 + 2);
        assert!(world_picture(&hall(4096, 257), String::new()).is_err());
        // Three paths of ten steps.
        assert_eq!(picture.matches("<polyline").count(), 3);
        assert_eq!(picture.matches("<use").count(), 3 * 10);
    }

    #[test]
    fn control_a_small_maze_is_drawn() {
        let plan = Plan::new(hall(40, 5)).arena(ArenaKind::Grid).episodes(1);
        let picture = drawn(plan).unwrap();
        assert_eq!(picture.moments[0].episode.episode, 1);
    }
}
