//! Learned knowledge, and an agent that follows it without learning.

mod frozen;

pub use frozen::Frozen;

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::{CONTEXT_BITS, Map, PERCEPT_BITS, Tracker};
use crate::agent::model::Generalisation;
use crate::agent::policy::plan::BeliefPlan;
use xcs::{Action, Layout, Percept, Population, PredictionArray, Xcs};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Maze;

/// Learned knowledge: enough to follow the greedy policy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Knowledge {
    /// The rules of an XCS.
    Rules(Population),
    /// The rules of an XCS that divides by the fitness of all of \[M\]
    /// (`xcs.value_over_match_set`).
    RulesOverMatchSet(Population),
    /// Rules over percepts, distilled from a plan, with the rules that predict transitions.
    PerceptRules {
        /// The rules for action values.
        rules: Population,
        /// The rules that predict transitions.
        generalisation: Generalisation,
    },
    /// The rules of a learner with a map. Their conditions match contexts, not percepts.
    MapRules {
        /// The rules for action values in a context.
        rules: Population,
        /// The map that contexts refer to.
        map: Map,
    },
    /// The plan of a tabular method with a map, and the map itself.
    Planned(BeliefPlan),
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

    /// Initialises an XCS with the rules; `false` if there are no rules with conditions on
    /// percepts.
    pub(in crate::agent) fn initialise(&self, xcs: &mut Xcs) -> bool {
        let rules = self.rules().filter(|_| !self.remembers());
        rules.map(|rules| xcs.start_from(rules)).is_some()
    }

    /// Returns the value of each of `actions` actions in a percept.
    pub fn values(&self, percept: &Percept, actions: usize) -> PredictionArray {
        match self {
            Self::Rules(rules) | Self::PerceptRules { rules, .. } => {
                rules.sums(percept).array(actions, false)
            }
            Self::RulesOverMatchSet(rules) => rules.sums(percept).array(actions, true),
            Self::MapRules { map, .. } => {
                self.tracked_values(&Tracker::at_start(map, percept), actions)
            }
            Self::Planned(plan) => plan.values(&Tracker::at_start(&plan.map, percept), actions),
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

    /// Continues planning for the tracked belief, if a plan chooses.
    pub(super) fn plan_for(&mut self, tracker: &Tracker) {
        if let Self::Planned(plan) = self {
            plan.plan_for(tracker);
        }
    }

    /// Returns the value of each action for the tracked state; empty without a map.
    pub(super) fn tracked_values(&self, tracker: &Tracker, actions: usize) -> PredictionArray {
        match self {
            Self::MapRules { map, .. } => self.values_in(&tracker.context(map), actions),
            Self::Planned(plan) => plan.values(tracker, actions),
            _ => PredictionArray::new(actions),
        }
    }

    /// Returns the value of each action for the input of the rules: a context, or a percept without
    /// a map.
    pub fn values_in(&self, rule_input: &Percept, actions: usize) -> PredictionArray {
        match self {
            Self::MapRules { rules, .. } => rules.sums(rule_input).array(actions, false),
            _ => self.values(rule_input, actions),
        }
    }

    /// Returns the width of the input of the rules, for percepts of `width` bits.
    fn context_width(&self, width: usize) -> usize {
        match self {
            Self::MapRules { .. } => CONTEXT_BITS,
            _ => width,
        }
    }

    /// Returns the input of the rules when an episode begins with a percept.
    pub fn rule_input(&self, percept: &Percept) -> Percept {
        match self {
            Self::MapRules { map, .. } => Tracker::at_start(map, percept).context(map),
            _ => *percept,
        }
    }

    /// Returns true if choices depend on more than the percept.
    pub fn remembers(&self) -> bool {
        self.map().is_some()
    }

    /// Returns the map, if there is one.
    fn map(&self) -> Option<&Map> {
        match self {
            Self::MapRules { map, .. } => Some(map),
            Self::Planned(plan) => Some(&plan.map),
            _ => None,
        }
    }

    /// Returns the rules for action values; `None` for a table or a plan.
    pub fn rules(&self) -> Option<&Population> {
        match self {
            Self::Rules(rules)
            | Self::RulesOverMatchSet(rules)
            | Self::PerceptRules { rules, .. }
            | Self::MapRules { rules, .. } => Some(rules),
            Self::Table(_) | Self::Planned(_) => None,
        }
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
    pub fn check(&self, sensor: Sensor, maze: &Maze) -> Result<(), Misfit> {
        let (width, actions) = (sensor.width(maze), maze.action_count());
        let layout = match self.remembers() {
            true => Layout::default(),
            false => sensor.layout(maze),
        };
        if let Some(map) = self.map()
            && !(map.is_valid(actions) && width >= PERCEPT_BITS)
        {
            return Err(Misfit::Map);
        }
        let rules = self.rules().map_or(&[][..], Population::rules).iter();
        let own = rules.map(|rule| (rule.condition, Some(rule.action)));
        let predicting = self
            .generalisation()
            .map_or(&[][..], |f| &f.collisions)
            .iter();
        let predicting = predicting.map(|rule| (rule.condition, rule.action));
        for (condition, action) in own.chain(predicting) {
            let action = action.map_or(0, Action::index);
            let wanted = self.context_width(width);
            Misfit::check(&condition, condition.width(), wanted, action, actions)?;
            if !layout.fits(&condition) {
                return Err(Misfit::Ranges(condition.to_string()));
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

    /// Returns the number of rules, of pairs in the table, or of planned beliefs.
    pub fn len(&self) -> usize {
        match self {
            Self::Table(table) => table.values().flatten().flatten().count(),
            Self::Planned(plan) => plan.planner.beliefs(),
            _ => self.rules().map_or(0, Population::len),
        }
    }

    /// Returns the unit of [`len`](Self::len): `rules`, `pairs` or `beliefs`.
    pub fn counts(&self) -> &'static str {
        match self {
            Self::Table(_) => "pairs",
            Self::Planned(_) => "beliefs",
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
    /// The map does not fit the moves and percepts of this world.
    #[error("the map of the rules does not fit the moves and percepts of this world")]
    Map,
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
