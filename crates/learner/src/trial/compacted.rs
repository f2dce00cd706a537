//! The fewest rules that keep all decisions in a maze.

use crate::agent::{Frozen, Knowledge, WithHistory};
use crate::episode::FaultFinder;
use xcs::{Population, fewest_rules};
use xcscr_robot::sensor::{History, Perception};
use xcscr_robot::world::{Maze, Paths};

/// The fewest rules of a learner that keep all its decisions in a maze, tested there.
#[derive(Debug, Clone, PartialEq)]
pub struct Compacted {
    /// The rules. Their conditions are as general as no decision changes, and their statistics are those of \[P\].
    pub rules: Population,
    /// True if their policy is globally optimal.
    pub optimal: bool,
}

impl Compacted {
    /// The maximum number of distinct percepts of a world; more would take minutes.
    pub const MOST_PERCEPTS: usize = 4096;

    /// Selects the fewest rules that keep the decisions in the [decided](Knowledge::decided) percepts. `None` for a
    /// table, and if there are more than [`MOST_PERCEPTS`](Self::MOST_PERCEPTS) such percepts.
    pub fn new(
        knowledge: &Knowledge,
        perception: impl Into<Perception>,
        maze: &Maze,
        paths: &Paths,
    ) -> Option<Self> {
        let (perception, actions) = (perception.into(), maze.action_count());
        let percepts = knowledge.decided(perception, maze, Self::MOST_PERCEPTS)?;
        let layout = perception.sensor.layout(maze);
        let over_match_set = knowledge.divides_over_match_set();
        let rules = knowledge.rules()?;
        let rules = fewest_rules(rules, &percepts, actions, &layout, over_match_set);
        let frozen = Box::new(Frozen::new(knowledge.with_rules(rules.clone()), actions, 1));
        let policy = WithHistory::around(frozen, History::new(perception, maze));
        let fault = FaultFinder::default().find(&*policy, perception.sensor, maze, paths);
        Some(Self {
            optimal: fault.is_none(),
            rules,
        })
    }
}

impl Knowledge {
    /// Returns the knowledge with only the fewest rules that keep all decisions in a maze: the policy that is shown and
    /// exported. Knowledge that [`Compacted::new`] does not accept is returned as it is.
    pub fn with_fewest_rules(&self, perception: impl Into<Perception>, maze: &Maze) -> Self {
        let few = Compacted::new(self, perception, maze, &Paths::new(maze));
        few.map_or_else(|| self.clone(), |few| self.with_rules(few.rules))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::Method;
    use crate::trial::{Plan, Trial};
    use xcscr_robot::arena::ArenaKind;

    #[test]
    fn the_fewest_rules_decide_like_all_rules_in_every_cell() {
        for (maze, most) in [("maze4", 15), ("maze5", 25), ("maze6", 20)] {
            let path = format!("{}/../../worlds/{maze}.json", env!("CARGO_MANIFEST_DIR"));
            let plan = Plan::new(Maze::load(path.as_ref()).unwrap()).method(Method::XcscrPlus);
            let mut trial = Trial::new(plan.arena(ArenaKind::Grid).episodes(40)).unwrap();
            let _ = trial.run(&mut ());
            let (knowledge, plan) = (trial.method().knowledge(), trial.plan());
            let (sensor, actions) = (plan.config.sensor, plan.maze.action_count());
            let few = Compacted::new(&knowledge, sensor, &plan.maze, trial.paths()).unwrap();
            let all = knowledge.rules().unwrap();
            assert!(
                few.rules.len() <= most && most < all.len(),
                "{maze}: {}",
                few.rules.len()
            );
            assert_eq!(few.optimal, trial.progress().optimal, "{maze}");
            let percepts = sensor.percepts(&plan.maze);
            for percept in percepts
                .into_iter()
                .filter(|percept| knowledge.decides(percept))
            {
                let [few, all] =
                    [&few.rules, all].map(|rules| rules.sums(&percept).array(actions, false));
                assert!(
                    few.best_actions().all(|action| all.is_nearly_best(action)),
                    "{maze} {percept}"
                );
            }
        }
    }
}
