//! An observer that looks at what was learned after some episodes.

use std::ops::ControlFlow;

use super::policy_picture::{Look, Margin, Moment, PolicyPicture, Stage};
use crate::agent::{Method, Sharing};
use crate::arena::View;
use crate::episode::{AfterEpisode, Ending, Episode, Observer, PolicyMap, Step};
use crate::trial::{Judge, Plan};
use crate::world::{Cell, Maze};
use xcs::Action;

/// The episodes after which a camera looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stages {
    /// One episode. The camera ends the run after it.
    After(u32),
    /// The [stages](Stage) of learning. The camera looks after each episode, and does not end the run.
    OfLearning,
}

/// An observer that looks at what was learned after some episodes.
pub(crate) struct Camera {
    stages: Stages,
    judge: Judge,
    /// The cells on shortest paths in which an action is chosen.
    on_shortest: Vec<Cell>,
    /// The cells that were visited in the present episode, the start first.
    visited: Vec<Cell>,
    /// The moment of the only episode or, without a success so far, of the last one.
    before: Option<Moment>,
    half: Option<Moment>,
    success: Option<Moment>,
    margins: Vec<Margin>,
}

impl Camera {
    /// Creates a camera for the run of a plan.
    pub(crate) fn new(stages: Stages, plan: &Plan) -> Self {
        let Plan { maze, config } = plan;
        let judge = Judge::new(maze, config.sensor, config.settings.arena.slip);
        let on_shortest = judge.paths().cells_on_shortest(maze);
        let on_shortest = on_shortest.filter(|&cell| !maze.is_goal(cell)).collect();
        Self {
            stages,
            judge,
            on_shortest,
            visited: Vec::new(),
            before: None,
            half: None,
            success: None,
            margins: Vec::new(),
        }
    }

    /// Returns the picture of all stages of the run of `plan` that were seen.
    pub(crate) fn picture(mut self, plan: &Plan, look: Look) -> PolicyPicture {
        let config = &plan.config;
        let (world, method) = (plan.maze.name(), config.method.name());
        let (arena, seed) = (config.arena.name(), config.seed);
        let is_last = |half: &Moment| {
            let success = self.success.as_ref().map(|moment| moment.episode.episode);
            Some(half.episode.episode) == success
        };
        // One panel is enough for an episode that is two stages.
        if self.half.as_ref().is_some_and(is_last) {
            self.half = None;
        }
        let moments = [self.before, self.half, self.success];
        PolicyPicture {
            maze: plan.maze.clone(),
            title: format!("{world}: {method} on {arena}, seed {seed}"),
            paths: self.judge.paths().clone(),
            look,
            moments: moments.into_iter().flatten().collect(),
            margins: self.margins,
            sharing: sharing(plan),
        }
    }

    fn moment(
        &mut self,
        stage: Option<Stage>,
        episode: &Episode,
        after: &AfterEpisode<'_>,
        policy: PolicyMap,
    ) -> Moment {
        let maze = after.view.maze;
        Moment {
            stage,
            episode: *episode,
            greedy_path: policy.greedy_path(maze, self.visited[0]),
            policy,
            optimal: self.judge.is_optimal(after.method, maze),
            visited: self.visited.clone(),
        }
    }

    /// Keeps the moments of the stages of learning, and the margins of the policy.
    fn look(&mut self, episode: &Episode, after: &AfterEpisode<'_>, policy: PolicyMap) {
        let margin = self.margin(episode.episode, after.view.maze, &policy);
        self.margins.extend(margin);
        let is_success = episode.ending == Ending::Goal;
        if !is_success && self.success.is_none() {
            self.before = Some(self.moment(Some(Stage::BeforeSuccess), episode, after, policy));
            return;
        }
        if self.half.is_none() && self.is_half_positive(&policy) {
            let policy = policy.clone();
            self.half = Some(self.moment(Some(Stage::HalfPositive), episode, after, policy));
        }
        if is_success {
            self.success = Some(self.moment(Some(Stage::LastSuccess), episode, after, policy));
        }
    }

    /// Returns true if the greatest value is above 0 in half of the cells on shortest paths.
    fn is_half_positive(&self, policy: &PolicyMap) -> bool {
        let cells = self.on_shortest.iter();
        let greatest = cells.filter_map(|&cell| policy.values(cell)?.greatest());
        2 * greatest.filter(|&value| value > 0.0).count() >= self.on_shortest.len()
    }

    /// Returns the margins of the optimal actions along the preferred shortest path; in all cells if episodes start
    /// anywhere. `None` if there is no cell with values of optimal and of other actions.
    fn margin(&self, episode: u32, maze: &Maze, policy: &PolicyMap) -> Option<Margin> {
        let cells = match maze.start() {
            Some(start) => self.preferred_path(start, maze, policy),
            None => self.on_shortest.clone(),
        };
        let margin = |&cell: &Cell| {
            let (_, optimal) = self.best(true, cell, maze, policy)?;
            let (_, other) = self.best(false, cell, maze, policy)?;
            Some(optimal - other)
        };
        let margins: Vec<f64> = cells.iter().filter_map(margin).collect();
        let least = margins.iter().copied().reduce(f64::min)?;
        let mean = margins.iter().sum::<f64>() / margins.len() as f64;
        Some(Margin {
            episode,
            mean,
            least,
        })
    }

    /// Returns the cells before the goal of the shortest path that takes the optimal action of the greatest value in
    /// each cell. It ends where no optimal action has a value.
    fn preferred_path(&self, start: Cell, maze: &Maze, policy: &PolicyMap) -> Vec<Cell> {
        let paths = self.judge.paths();
        let onward = |&cell: &Cell| {
            let (action, _) = self.best(true, cell, maze, policy)?;
            paths.successor(maze, cell, action)
        };
        let path = std::iter::successors(Some(start), onward);
        let path = path.take_while(|&cell| !maze.is_goal(cell));
        // Where moves slip, a best action may lead back.
        path.take(self.on_shortest.len()).collect()
    }

    /// Returns the action with the greatest value in a cell, and this value, among the optimal or the other actions.
    fn best(
        &self,
        is_optimal: bool,
        cell: Cell,
        maze: &Maze,
        policy: &PolicyMap,
    ) -> Option<(Action, f64)> {
        let values = policy.values(cell)?;
        let paths = self.judge.paths();
        let wanted = |action: &Action| paths.successor(maze, cell, *action).is_some() == is_optimal;
        let actions = Action::all(maze.action_count()).filter(wanted);
        let known = actions.filter_map(|action| Some((action, values.get(action)?)));
        known.reduce(|one, other| if other.1 > one.1 { other } else { one })
    }
}

impl Observer for Camera {
    fn began(&mut self, _: u32, view: &View<'_>) {
        self.visited = vec![view.cell];
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.visited.push(step.view.cell);
    }

    fn ended(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> ControlFlow<()> {
        let policy = || PolicyMap::of(after.method, after.sensor, after.view.maze);
        match self.stages {
            Stages::After(number) if number == episode.episode => {
                self.before = Some(self.moment(None, episode, after, policy()));
                ControlFlow::Break(())
            }
            Stages::After(_) => ControlFlow::Continue(()),
            Stages::OfLearning => {
                self.look(episode, after, policy());
                ControlFlow::Continue(())
            }
        }
    }
}

/// Returns how the method shares the reward of an episode among its steps, if it does.
fn sharing(plan: &Plan) -> Option<Sharing> {
    match plan.config.method {
        Method::AdaptedEven => Some(Sharing::Even),
        Method::AdaptedDiscounted => Some(Sharing::Discounted),
        Method::Xcscr | Method::XcscrCoevolved => Some(plan.config.settings.reward.sharing),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::ArenaKind;
    use crate::trial::Trial;

    /// Trains in Maze5, which has one shortest path. Returns whether the policy is optimal, and the camera.
    fn trained(method: Method, episodes: u32) -> (bool, Camera) {
        let maze = Maze::load("worlds/maze5.json".as_ref()).unwrap();
        let mut plan = Plan::new(maze)
            .arena(ArenaKind::Grid)
            .method(method)
            .episodes(episodes);
        // Random steps hardly find the goal in the first episode.
        plan.config.settings.reward.step_threshold = 60;
        let mut trial = Trial::new(plan.clone()).unwrap();
        let mut camera = Camera::new(Stages::OfLearning, &plan);
        let _ = trial.run(&mut camera);
        (trial.progress().optimal, camera)
    }

    #[test]
    fn the_least_margin_is_above_0_if_and_only_if_the_policy_is_optimal() {
        let mut seen = Vec::new();
        for episodes in [2, 180] {
            let (is_optimal, camera) = trained(Method::QLearning, episodes);
            assert_eq!(camera.margins.len() as u32, episodes);
            let last = camera.margins.last().unwrap();
            assert_eq!(last.least > 0.0, is_optimal, "{last:?}");
            assert!(last.mean >= last.least);
            seen.push(is_optimal);
        }
        assert_eq!(seen, [false, true], "control: both cases");
    }

    #[test]
    fn the_stages_follow_each_other_and_values_are_below_0_before_the_first_success() {
        let (_, camera) = trained(Method::Xcscr, 180);
        let stages = [&camera.before, &camera.half, &camera.success];
        let stages = stages.map(|moment| moment.as_ref().unwrap());
        let [before, half, success] = stages.map(|moment| moment.episode);
        assert!(before.episode < half.episode && half.episode < success.episode);
        assert_eq!(
            (before.ending, success.ending),
            (Ending::StepLimit, Ending::Goal)
        );
        let above = |moment: &Moment| {
            let cells = moment.policy.cells();
            let values = cells.flat_map(|(_, values)| values.as_slice().iter().flatten());
            values.filter(|&&value| value > 0.0).count()
        };
        assert_eq!(above(stages[0]), 0);
        assert!(above(stages[1]) > 0, "control");
    }
}
