//! Learned knowledge, and an agent that follows it without learning.

mod frozen;

pub use frozen::Frozen;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::agent::model::Generalisation;
use xcs::{Action, Condition, Percept, Population, PredictionArray, Xcs};
use xcscr_robot::sensor::{History, MOST_EARLIER_STEPS, Perception};
use xcscr_robot::world::{Cell, Maze};

/// Learned knowledge: enough to follow the greedy policy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Knowledge {
    /// The rules of an XCS.
    Rules(Population),
    /// The rules of an XCS that divides by the fitness of all of \[M\]
    /// (`xcs.value_over_match_set`).
    RulesOverMatchSet(Population),
    /// The rules of an XCS with a learned model, and the rules of the model.
    PerceptRules {
        /// The rules for action values.
        rules: Population,
        /// The rules that predict transitions.
        generalisation: Generalisation,
        /// The percepts from which the model knows a path to a goal. Only there has the learner a decision.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        known: Vec<Percept>,
    },
    /// The table of a tabular method: the value of each action in each percept.
    Table(BTreeMap<Percept, Vec<Option<f64>>>),
}

impl Knowledge {
    /// Returns what an XCS has learned.
    pub(in crate::agent) fn of(xcs: &Xcs) -> Self {
        let rules = xcs.population().clone();
        match xcs.params().value_over_match_set {
            true => Self::RulesOverMatchSet(rules),
            false => Self::Rules(rules),
        }
    }

    /// Initialises an XCS with the rules; `false` if there are no rules.
    pub(in crate::agent) fn initialise(&self, xcs: &mut Xcs) -> bool {
        self.rules().map(|rules| xcs.start_from(rules)).is_some()
    }

    /// Returns the value of each of `actions` actions in a percept.
    pub fn values(&self, percept: &Percept, actions: usize) -> PredictionArray {
        match self {
            Self::Rules(rules) | Self::PerceptRules { rules, .. } => {
                rules.sums(percept).array(actions, false)
            }
            Self::RulesOverMatchSet(rules) => rules.sums(percept).array(actions, true),
            Self::Table(table) => {
                let mut array = PredictionArray::new(actions);
                let row = table.get(percept).map_or(&[][..], Vec::as_slice);
                for (action, values) in Action::all(actions).zip(row) {
                    values.iter().for_each(|&values| array.set(action, values));
                }
                array
            }
        }
    }

    /// Returns the rules for action values; `None` for a table.
    pub fn rules(&self) -> Option<&Population> {
        match self {
            Self::Rules(rules)
            | Self::RulesOverMatchSet(rules)
            | Self::PerceptRules { rules, .. } => Some(rules),
            Self::Table(_) => None,
        }
    }

    /// Returns true if action values are divided by the fitness of all of \[M\].
    pub fn divides_over_match_set(&self) -> bool {
        matches!(self, Self::RulesOverMatchSet(_))
    }

    /// Returns the knowledge with other rules.
    pub fn with_rules(&self, rules: Population) -> Self {
        match self {
            Self::Rules(_) | Self::Table(_) => Self::Rules(rules),
            Self::RulesOverMatchSet(_) => Self::RulesOverMatchSet(rules),
            Self::PerceptRules {
                generalisation,
                known,
                ..
            } => Self::PerceptRules {
                rules,
                generalisation: generalisation.clone(),
                known: known.clone(),
            },
        }
    }

    /// Returns the knowledge for another world or sensor. Which percepts are known does not carry over, so the learner
    /// decides wherever its rules match.
    #[must_use]
    pub fn elsewhere(mut self) -> Self {
        if let Self::PerceptRules { known, .. } = &mut self {
            known.clear();
        }
        self
    }

    /// Returns true if the learner has a decision in a percept: if its model knows a path to a goal from there, or for
    /// learners without a model.
    pub fn decides(&self, percept: &Percept) -> bool {
        match self {
            Self::PerceptRules { known, .. } => {
                known.is_empty() || known.binary_search(percept).is_ok()
            }
            _ => true,
        }
    }

    /// Returns the percepts of a maze in which the learner has a decision; `None` if there are more than `most`. With
    /// earlier steps in the percept, these are the percepts that the greedy policy meets.
    pub fn decided(
        &self,
        perception: Perception,
        maze: &Maze,
        most: usize,
    ) -> Option<Vec<Percept>> {
        let mut percepts = match perception.history {
            0 => perception.at_most_percepts(maze, most)?,
            _ => self.met(perception, maze, most)?,
        };
        percepts.retain(|percept| self.decides(percept));
        Some(percepts)
    }

    /// Returns the percepts that the greedy policy meets on exact moves from all starts, with all nearly best actions
    /// on ties; `None` if they are more than `most`.
    fn met(&self, perception: Perception, maze: &Maze, most: usize) -> Option<Vec<Percept>> {
        let beginning = History::new(perception, maze);
        let mut open: Vec<(Cell, History)> = maze.starts().map(|cell| (cell, beginning)).collect();
        let (mut seen, mut met) = (BTreeSet::new(), BTreeSet::new());
        while let Some((cell, history)) = open.pop() {
            if maze.is_goal(cell) || !seen.insert((maze.index(cell), history)) {
                continue;
            }
            let here = perception.sensor.perceive_at(maze, cell);
            let percept = history.behind(&here);
            if met.insert(percept) && met.len() > most {
                return None;
            }
            let values = self.values(&percept, maze.action_count());
            for action in Action::all(maze.action_count()) {
                if values.is_nearly_best(action) {
                    let direction = maze.direction(action);
                    let next = direction.and_then(|direction| maze.step(cell, direction));
                    open.push((next.unwrap_or(cell), history.after(&here, action)));
                }
            }
        }
        Some(met.into_iter().collect())
    }

    /// Returns the transition generalisation; `None` for methods without one.
    pub fn generalisation(&self) -> Option<&Generalisation> {
        match self {
            Self::PerceptRules { generalisation, .. } => Some(generalisation),
            _ => None,
        }
    }

    /// Checks that the knowledge fits the percepts and the moves of a maze.
    ///
    /// # Errors
    /// The first rule or row that does not fit.
    pub fn check(&self, perception: impl Into<Perception>, maze: &Maze) -> Result<(), Misfit> {
        let perception = perception.into();
        let (width, actions) = (perception.width(maze), maze.action_count());
        let layout = perception.sensor.layout(maze);
        let rules = self.rules().map_or(&[][..], Population::rules).iter();
        let own = rules.map(|rule| (rule.condition, Some(rule.action)));
        let predicting = self
            .generalisation()
            .map_or(&[][..], |f| &f.collisions)
            .iter();
        let predicting = predicting.map(|rule| (rule.condition, rule.action));
        for (condition, action) in own.chain(predicting) {
            Misfit::check_history(&condition, perception, maze)?;
            let action = action.map_or(0, Action::index);
            Misfit::check(&condition, condition.width(), width, action, actions)?;
            if !layout.fits(&condition) {
                return Err(Misfit::Ranges(condition.to_string()));
            }
        }
        if let Self::PerceptRules { known, .. } = self {
            for percept in known {
                Misfit::check(percept, percept.width(), width, 0, actions)?;
            }
            if !known.is_sorted_by(|a, b| a < b) {
                return Err(Misfit::Unsorted);
            }
        }
        if let Self::Table(table) = self {
            for (percept, row) in table {
                let last = row.len().saturating_sub(1);
                Misfit::check(percept, percept.width(), width, last, actions)?;
            }
        }
        self.generalisation().map_or(Ok(()), |generalisation| {
            generalisation
                .check(actions)
                .map_err(Misfit::Generalisation)
        })
    }

    /// Returns the number of rules, or of pairs in the table.
    pub fn len(&self) -> usize {
        match self {
            Self::Table(table) => table.values().flatten().flatten().count(),
            _ => self.rules().map_or(0, Population::len),
        }
    }

    /// Returns the unit of [`len`](Self::len): `rules` or `pairs`.
    pub fn counts(&self) -> &'static str {
        match self {
            Self::Table(_) => "pairs",
            _ => "rules",
        }
    }

    /// Returns true if nothing was learned.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Errors when knowledge does not fit a world.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// The condition of a rule has another width than the percepts.
    #[error("rule {rule} looks at {width} bits, but percepts in this world have {wanted}")]
    Width {
        /// The condition of the rule.
        rule: String,
        /// The width of the condition.
        width: usize,
        /// The width of percepts.
        wanted: usize,
    },
    /// The condition of a rule is as wide as percepts with another number of earlier steps.
    #[error(
        "rule {rule} is as wide as percepts with `sensor.history` {fitting}, but here it is {wanted}: use the percept \
         and the history of its run, which the folder of the run names"
    )]
    History {
        /// The condition of the rule.
        rule: String,
        /// The number of earlier steps that fits the width of the condition.
        fitting: u32,
        /// The number of earlier steps in the percepts.
        wanted: u32,
    },
    /// The condition of a rule has a range in place of other bits than those of the column or the row.
    #[error("rule {0} has a range that is not of the column or the row of this world's percepts")]
    Ranges(String),
    /// A rule advocates an action that is not a move of this world.
    #[error(
        "rule {rule} advocates action {action}, but this world has only {actions} moves, counted from 0"
    )]
    Action {
        /// The condition of the rule.
        rule: String,
        /// The action.
        action: usize,
        /// The number of actions.
        actions: usize,
    },
    /// The known percepts are not sorted, or one is listed twice.
    #[error("the known percepts are not sorted, or one is listed twice")]
    Unsorted,
    /// The transition generalisation is invalid.
    #[error("{0}")]
    Generalisation(String),
    /// The method cannot use this kind of knowledge.
    #[error(
        "the method `{0}` cannot start from these rules: XCS methods accept the rules of an XCS method, \
         xcscr-plus accepts its own rules, and tabular methods accept none"
    )]
    Useless(&'static str),
}

impl Misfit {
    /// Checks that the condition is not one on percepts with another number of earlier steps.
    fn check_history(rule: &Condition, perception: Perception, maze: &Maze) -> Result<(), Self> {
        let wanted = perception.history;
        let mut others = (0..=MOST_EARLIER_STEPS).filter(|&history| history != wanted);
        let fitting = others.find(|&history| {
            let other = Perception {
                history,
                ..perception
            };
            other.width(maze) == rule.width()
        });
        fitting.map_or(Ok(()), |fitting| {
            Err(Self::History {
                rule: rule.to_string(),
                fitting,
                wanted,
            })
        })
    }

    fn check(
        rule: &dyn fmt::Display,
        width: usize,
        wanted: usize,
        action: usize,
        actions: usize,
    ) -> Result<(), Self> {
        if width != wanted {
            return Err(Self::Width {
                rule: rule.to_string(),
                width,
                wanted,
            });
        }
        if action >= actions {
            return Err(Self::Action {
                rule: rule.to_string(),
                action,
                actions,
            });
        }
        Ok(())
    }
}
