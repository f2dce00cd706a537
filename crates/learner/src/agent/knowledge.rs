//! What a learner knows.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::{CONTEXT_BITS, Map, PERCEPT_BITS, Tracker};
use crate::agent::model::Generalisation;
use crate::agent::policy::plan::BeliefPlan;
use xcs::{Action, Percept};
use xcs::{Population, PredictionArray, Xcs};

/// What was learned: enough to follow the greedy policy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Knowledge {
    /// The rules of an XCS.
    Rules(Population),
    /// The rules of an XCS that divides by the fitness of all of \[M\] (`xcs.worth_over_match_set`).
    RulesOverMatchSet(Population),
    /// The rules of an XCS that also foresees what actions do.
    Foresighted {
        /// What actions are worth.
        rules: Population,
        /// What they do.
        generalisation: Generalisation,
    },
    /// The rules of a learner with a memory, which look at a context, not at a percept.
    Remembering {
        /// What actions are worth in a context.
        rules: Population,
        /// The places that contexts speak of.
        map: Map,
    },
    /// The plan of a tabular method with a memory, and its maps.
    Planned(BeliefPlan),
    /// The table of a tabular method: the value of each action in each percept.
    Table(BTreeMap<Percept, Vec<Option<f64>>>),
}

impl Knowledge {
    /// What an XCS has learned.
    pub(super) fn of(xcs: &Xcs) -> Self {
        let rules = xcs.population().clone();
        match xcs.params().value_over_match_set {
            true => Self::RulesOverMatchSet(rules),
            false => Self::Rules(rules),
        }
    }

    /// Lets an XCS start from the rules; `false` if there are none that look at percepts.
    pub(super) fn bring_to(&self, xcs: &mut Xcs) -> bool {
        let rules = self.rules().filter(|_| !self.remembers());
        rules.map(|rules| xcs.start_from(rules)).is_some()
    }

    /// The value of each of `actions` actions under a percept.
    pub fn values(&self, percept: &Percept, actions: usize) -> PredictionArray {
        match self {
            Self::Rules(rules) | Self::Foresighted { rules, .. } => {
                rules.sums(percept).array(actions, false)
            }
            Self::RulesOverMatchSet(rules) => rules.sums(percept).array(actions, true),
            Self::Remembering { map, .. } => self.remembered_values(&begun(map, percept), actions),
            Self::Planned(plan) => plan.values(&begun(plan.map(), percept), actions),
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

    /// Plans on for one who remembers an episode, where a plan chooses.
    pub(super) fn plan_for(&mut self, tracker: &Tracker) {
        if let Self::Planned(plan) = self {
            plan.plan_for(tracker);
        }
    }

    /// The value of each action for one who remembers an episode; none without a memory.
    pub(super) fn remembered_values(&self, tracker: &Tracker, actions: usize) -> PredictionArray {
        match self {
            Self::Remembering { map, .. } => self.values_in(&tracker.context(map), actions),
            Self::Planned(plan) => plan.values(tracker, actions),
            _ => PredictionArray::new(actions),
        }
    }

    /// The value of each action in what its rules look at: a context, or without a memory a percept.
    pub fn values_in(&self, looked_at: &Percept, actions: usize) -> PredictionArray {
        match self {
            Self::Remembering { rules, .. } => rules.sums(looked_at).array(actions, false),
            _ => self.values(looked_at, actions),
        }
    }

    /// The width of what its rules look at, for percepts of `width` bits.
    fn context_width(&self, width: usize) -> usize {
        match self {
            Self::Remembering { .. } => CONTEXT_BITS,
            _ => width,
        }
    }

    /// What its rules look at when an episode begins with a percept.
    pub fn looked_at(&self, percept: &Percept) -> Percept {
        match self {
            Self::Remembering { map, .. } => begun(map, percept).context(map),
            _ => *percept,
        }
    }

    /// Does what is chosen depend on more than the percept?
    pub fn remembers(&self) -> bool {
        self.map().is_some()
    }

    /// The maps of those that remember.
    pub(super) fn map(&self) -> Option<&Map> {
        match self {
            Self::Remembering { map, .. } => Some(map),
            Self::Planned(plan) => Some(plan.map()),
            _ => None,
        }
    }

    /// The rules that say what actions are worth; `None` for a table or a plan.
    pub fn rules(&self) -> Option<&Population> {
        match self {
            Self::Rules(rules)
            | Self::RulesOverMatchSet(rules)
            | Self::Foresighted { rules, .. }
            | Self::Remembering { rules, .. } => Some(rules),
            Self::Table(_) | Self::Planned(_) => None,
        }
    }

    /// What is predicted; `None` for methods that foresee nothing.
    pub fn generalisation(&self) -> Option<&Generalisation> {
        match self {
            Self::Foresighted { generalisation, .. } => Some(generalisation),
            _ => None,
        }
    }

    /// Accepts what is known when it is about percepts of `width` bits and `actions` actions.
    ///
    /// # Errors
    /// The first rule or row that is not.
    pub fn check(&self, width: usize, actions: usize) -> Result<(), Misfit> {
        if let Some(map) = self.map()
            && !(map.is_sound(actions) && width >= PERCEPT_BITS)
        {
            return Err(Misfit::Map);
        }
        let rules = self.rules().map_or(&[][..], Population::rules).iter();
        let own = rules.map(|rule| (rule.condition, Some(rule.action)));
        let foretelling = self
            .generalisation()
            .map_or(&[][..], |f| &f.collisions)
            .iter();
        let foretelling = foretelling.map(|rule| (rule.condition, rule.action));
        for (condition, action) in own.chain(foretelling) {
            let action = action.map_or(0, Action::index);
            let wanted = self.context_width(width);
            Misfit::check(&condition, condition.width(), wanted, action, actions)?;
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

    /// The number of rules, of pairs in the table, or of beliefs that were planned for.
    pub fn len(&self) -> usize {
        match self {
            Self::Table(table) => table.values().flatten().flatten().count(),
            Self::Planned(plan) => plan.beliefs(),
            _ => self.rules().map_or(0, Population::len),
        }
    }

    /// What [`len`](Self::len) counts: `rules`, `pairs` or `beliefs`.
    pub fn counts(&self) -> &'static str {
        match self {
            Self::Table(_) => "pairs",
            Self::Planned(_) => "beliefs",
            _ => "rules",
        }
    }

    /// Is nothing known?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What is remembered when an episode begins with a percept.
fn begun(map: &Map, percept: &Percept) -> Tracker {
    let mut begun = Tracker::default();
    begun.perceive(map, percept);
    begun
}

/// Knowledge of another world.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// A rule looks at percepts of another width.
    #[error("rule {rule} looks at {width} bits, but percepts in this world have {wanted}")]
    Width {
        /// Its condition.
        rule: String,
        /// The width of the condition.
        width: usize,
        /// The width of percepts.
        wanted: usize,
    },
    /// A rule advocates an action that is no move.
    #[error(
        "rule {rule} advocates action {action}, but this world has only {actions} moves, counted from 0"
    )]
    Action {
        /// Its condition.
        rule: String,
        /// The action.
        action: usize,
        /// How many there are.
        actions: usize,
    },
    /// What is remembered is no map for these moves and percepts.
    #[error("the map that the rules go by does not fit the moves and percepts of this world")]
    Map,
    /// What is predicted cannot be.
    #[error("{0}")]
    Generalisation(String),
    /// They are of another kind than the method's.
    #[error(
        "the method `{0}` cannot start from these rules: give XCS methods rules of one of them, \
         and xcscr-plus rules of its own; tabular methods start from nothing"
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
        let rule = || rule.to_string();
        if width != wanted {
            let rule = rule();
            return Err(Self::Width {
                rule,
                width,
                wanted,
            });
        }
        if action >= actions {
            let rule = rule();
            return Err(Self::Action {
                rule,
                action,
                actions,
            });
        }
        Ok(())
    }
}
