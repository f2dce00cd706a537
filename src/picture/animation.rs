//! Animations: the policy after one episode or after several.

use std::ops::ControlFlow;

use super::{drawing, moving_png, pixels};
use crate::agent::Knowledge;
use crate::arena::View;
use crate::episode::{Ending, Episode, Learned, Observer, PolicyMap, Step};
use crate::error::{Error, ErrorKind};
use crate::trial::{Judge, Plan, steps_to_goal};
use crate::world::{Cell, Maze, Paths};

/// The most frames of an animation. If the policy changes more often, some changes are skipped.
const MOST_FRAMES: usize = 45;
/// The most cells of a maze that is drawn. The SVG of such a maze takes 145 MB.
const MOST_CELLS: usize = 1 << 20;
/// The most cells of a maze in a PNG file. Rendering one takes some 3 kB of memory per cell.
const MOST_PNG_CELLS: usize = 1 << 18;

/// The episodes to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scenes {
    /// The policy after the last episode.
    Last,
    /// The policy after this episode, counted from 1.
    After(u32),
    /// The policy after each episode that changed a best action, in at most 45 frames.
    Forming,
}

/// A frame of an animation: an episode and the policy after it.
#[derive(Debug, Clone)]
pub(super) struct Moment {
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

/// An animation of one frame or several over the maze. Rendering is deterministic: the same
/// animation gives the same bytes.
#[derive(Debug, Clone)]
pub struct Animation {
    pub(super) maze: Maze,
    pub(super) title: String,
    /// A note about the arrows, or an empty string.
    pub(super) arrows: &'static str,
    pub(super) paths: Paths,
    pub(super) moments: Vec<Moment>,
}

impl Animation {
    /// Collects the frames while `watch` repeats the run of the plan for an observer, as far as needed.
    ///
    /// # Errors
    /// When the run has no such episode, when the maze has more than a million cells, and the errors of
    /// `watch`.
    pub(crate) fn of(
        plan: &Plan,
        scenes: Scenes,
        watch: impl FnOnce(&mut dyn Observer) -> Result<Knowledge, Error>,
    ) -> Result<Self, Error> {
        let instead = "`xcscr rules RUN --cell COL,ROW` shows what was learned in one cell";
        check_size(&plan.maze, MOST_CELLS, "drawn", instead)?;
        let episodes = plan.config.episodes;
        let last = match scenes {
            Scenes::Last | Scenes::Forming => episodes,
            Scenes::After(wanted) if (1..=episodes).contains(&wanted) => wanted,
            Scenes::After(wanted) => {
                let message = format!("there is no episode {wanted}: the run has {episodes}");
                return Err(ErrorKind::Usage.error(message));
            }
        };
        let mut camera = Camera::new(last, scenes == Scenes::Forming, plan);
        // The camera ends the run.
        watch(&mut camera)?;
        let config = &plan.config;
        let (world, method) = (plan.maze.name(), config.method.name());
        let (arena, seed) = (config.arena.name(), config.seed);
        let arrows = match camera.remembers {
            true => "each arrow: the best action if an episode begins in that cell",
            false => "",
        };
        Ok(Self {
            maze: plan.maze.clone(),
            title: format!("{world}: {method} on {arena}, seed {seed}"),
            arrows,
            paths: camera.judge.paths().clone(),
            moments: camera.moments,
        })
    }

    /// Renders an SVG document, animated if there are several frames.
    pub fn svg(&self) -> String {
        drawing::draw(self).document()
    }

    /// Renders a PNG file, animated (APNG) if there are several frames.
    ///
    /// # Errors
    /// When the picture is too large.
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        check_size(
            &self.maze,
            MOST_PNG_CELLS,
            "drawn as PNG",
            "write an .svg file",
        )?;
        let drawing = drawing::draw(self);
        let picture = match drawing.frames.len() {
            1 => pixels::png(&drawing.document()),
            _ => moving_png::png(&drawing),
        };
        picture
            .map_err(|fault| ErrorKind::BadData.error(format!("cannot draw the picture: {fault}")))
    }
}

/// Rejects a maze of more than `most` cells, and suggests what to do instead.
fn check_size(maze: &Maze, most: usize, done: &str, instead: &str) -> Result<(), Error> {
    let cells = usize::from(maze.width()) * usize::from(maze.height());
    if cells <= most {
        return Ok(());
    }
    let name = maze.name();
    Err(ErrorKind::BadData.error(format!(
        "cannot draw the picture: {name} has {cells} cells, but at most {most} can be {done}; {instead}"
    )))
}

/// An observer that collects frames.
struct Camera {
    last: u32,
    /// True if changes are shown, and not only the last episode.
    shows_changes: bool,
    /// The number of changes so far. One in `stride` changes is kept.
    changes: usize,
    stride: usize,
    judge: Judge,
    /// True if decisions depend on earlier percepts of the episode.
    remembers: bool,
    visited: Vec<Cell>,
    moments: Vec<Moment>,
}

impl Camera {
    fn new(last: u32, shows_changes: bool, plan: &Plan) -> Self {
        let Plan { maze, config } = plan;
        Self {
            last,
            shows_changes,
            changes: 0,
            stride: 1,
            judge: Judge::new(maze, config.sensor, config.settings.arena.slip),
            remembers: false,
            visited: Vec::new(),
            moments: Vec::new(),
        }
    }

    /// Returns true if this policy is a change to keep. Counts the change and thins the frames if
    /// necessary.
    fn keeps(&mut self, policy: &PolicyMap) -> bool {
        let before = self.moments.last();
        if !self.shows_changes || before.is_some_and(|before| agree(&before.policy, policy)) {
            return false;
        }
        let number = self.changes;
        self.changes += 1;
        // One frame is reserved for the last episode.
        if self.moments.len() == MOST_FRAMES - 1 {
            let mut at = 0..;
            self.moments
                .retain(|_| at.next().is_some_and(|at: usize| at.is_multiple_of(2)));
            self.stride *= 2;
        }
        number.is_multiple_of(self.stride)
    }
}

/// Returns true if two policies have the same best actions in all cells.
fn agree(one: &PolicyMap, other: &PolicyMap) -> bool {
    let both = one.cells().zip(other.cells());
    one.cells().count() == other.cells().count()
        && both.into_iter().all(|((cell, values), (there, other))| {
            cell == there && values.best_actions().eq(other.best_actions())
        })
}

impl Observer for Camera {
    fn began(&mut self, _: u32, view: &View<'_>) {
        self.visited = vec![view.cell];
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.visited.push(step.view.cell);
    }

    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        let is_last = episode.episode == self.last;
        if !is_last && !self.shows_changes {
            return ControlFlow::Continue(());
        }
        let (method, sensor, maze) = (learned.method, learned.sensor, learned.view.maze);
        let policy = PolicyMap::of(method, sensor, maze);
        self.remembers = method.remembers();
        if self.keeps(&policy) || is_last {
            let from = self.visited[0];
            self.moments.push(Moment {
                episode: *episode,
                greedy_path: self.judge.greedy_path(method, &policy, maze, from),
                policy,
                optimal: self.judge.is_optimal(method, maze),
                visited: std::mem::take(&mut self.visited),
            });
        }
        match is_last {
            false => ControlFlow::Continue(()),
            true => ControlFlow::Break(()),
        }
    }
}

impl Moment {
    /// The caption below the title.
    pub(super) fn caption(&self, maze: &Maze, paths: &Paths) -> String {
        let Episode {
            episode,
            steps,
            ending,
            ..
        } = self.episode;
        let how = match ending {
            Ending::Goal => "to the goal",
            Ending::StepLimit => "and gave up",
        };
        let from = self.visited[0];
        let shortest = paths.distance(maze, from);
        let greedy = match steps_to_goal(&self.greedy_path, maze) {
            Some(now) if paths.slips() => format!("{now} steps when nothing slips"),
            Some(now) if Some(now) == shortest => format!("{now} steps, the fewest"),
            Some(now) => format!("{now} steps"),
            None => "never arrives".to_owned(),
        };
        // Where actions slip, the fewest steps are not a meaningful reference.
        let verdict = match paths.slips() && self.optimal {
            true => "; the policy is optimal",
            false => "",
        };
        format!("episode {episode}: {steps} steps {how}; greedy path now: {greedy}{verdict}")
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::agent::Method;
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

    fn filmed(plan: Plan, scenes: Scenes) -> Result<Animation, Error> {
        Animation::of(&plan, scenes, |camera| {
            let mut trial = Trial::new(plan.clone())?;
            let _ = trial.run(camera);
            Ok(trial.method().knowledge())
        })
    }

    #[test]
    fn a_maze_of_more_than_a_million_cells_is_not_drawn_and_the_message_suggests_an_alternative() {
        let plan = Plan::new(hall(4096, 257)).episodes(1);
        let refused = filmed(plan, Scenes::Last).err();
        let refused = refused.expect("it has too many cells").to_string();
        for part in ["hall has 1052672 cells", "xcscr rules RUN --cell COL,ROW"] {
            assert!(refused.contains(part), "{refused}");
        }
    }

    #[test]
    fn a_png_file_of_too_many_cells_is_refused_and_the_message_suggests_an_svg_file() {
        let maze = hall(1024, 257);
        let animation = Animation {
            title: String::new(),
            arrows: "",
            paths: Paths::new(&maze),
            moments: Vec::new(),
            maze,
        };
        let refused = animation.png().expect_err("it has too many cells");
        assert!(
            refused.to_string().contains("write an .svg file"),
            "{refused}"
        );
    }

    #[test]
    fn control_a_small_maze_is_drawn() {
        let plan = Plan::new(hall(40, 5)).arena(ArenaKind::Grid).episodes(1);
        let animation = filmed(plan, Scenes::Last).unwrap();
        assert_eq!(animation.moments.len(), 1);
    }

    #[test]
    fn an_animation_shows_the_episodes_that_changed_the_policy_and_the_last_one() {
        let plan = Plan::new(hall(40, 5)).arena(ArenaKind::Grid).episodes(30);
        let animation = filmed(plan, Scenes::Forming).unwrap();
        let [before @ .., last] = &animation.moments[..] else {
            panic!("there is no frame");
        };
        assert_eq!(last.episode.episode, 30);
        assert!((2..30).contains(&before.len()), "{}", before.len());
        for pair in before.windows(2) {
            assert!(!agree(&pair[0].policy, &pair[1].policy));
        }
    }

    #[test]
    fn frames_are_thinned_if_there_are_many_changes() {
        let maze = Maze::find(Path::new("maze4")).unwrap();
        let plan = Plan::new(maze).method(Method::Xcscr);
        let animation = filmed(plan.arena(ArenaKind::Grid).episodes(300), Scenes::Forming).unwrap();
        let shown = animation.moments.len();
        assert!((20..=MOST_FRAMES).contains(&shown), "{shown}");
    }
}
