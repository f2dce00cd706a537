//! The history of a rule.

use std::ops::ControlFlow;

use super::Trial;
use super::plan::{Plan, PlanError};
use crate::agent::Knowledge;
use crate::episode::{Episode, Learned, Observer};
use xcs::{Action, Classifier, Condition, Population};

/// A rule over the episodes of a run.
#[derive(Debug, Clone)]
pub struct RuleHistory {
    /// The last episode at whose end the rule entered \[P\].
    pub since: u32,
    /// The episodes that changed its prediction, in order.
    pub changes: Vec<PredictionChange>,
}

/// An episode that changed the prediction of a rule.
#[derive(Debug, Clone, Copy)]
pub struct PredictionChange {
    /// The figures of the episode.
    pub episode: Episode,
    /// The prediction before; `None` if the rule was not in \[P\].
    pub before: Option<f64>,
    /// The prediction afterwards.
    pub after: f64,
}

impl PredictionChange {
    /// Returns the absolute change of the prediction. The change of a new rule is counted from 0.
    pub fn moved(&self) -> f64 {
        (self.after - self.before.unwrap_or(0.0)).abs()
    }
}

impl RuleHistory {
    /// Runs the trial again and tracks the rule with this condition and action; `None` if the rule
    /// is not in the final \[P\].
    ///
    /// # Errors
    /// When the plan cannot be run.
    pub fn of(
        plan: &Plan,
        condition: Condition,
        action: Action,
    ) -> Result<Option<Self>, PlanError> {
        let mut watch = Watch {
            condition,
            action,
            present: None,
            history: None,
        };
        // The observer never ends the trial early.
        let _ = Trial::new(plan.clone())?.run(&mut watch);
        Ok(watch.history)
    }
}

/// Tracks one rule after each episode.
struct Watch {
    condition: Condition,
    action: Action,
    /// The last prediction, while the rule is in \[P\].
    present: Option<f64>,
    history: Option<RuleHistory>,
}

impl Watch {
    fn prediction(&self, knowledge: &Knowledge) -> Option<f64> {
        let rules = knowledge.rules().map_or(&[][..], Population::rules);
        let is_it =
            |rule: &&Classifier| (rule.condition, rule.action) == (self.condition, self.action);
        rules.iter().find(is_it).map(|rule| rule.prediction)
    }
}

impl Observer for Watch {
    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        let before = self.present;
        self.present = self.prediction(&learned.method.knowledge());
        let Some(after) = self.present else {
            self.history = None;
            return ControlFlow::Continue(());
        };
        let history = self.history.get_or_insert_with(|| RuleHistory {
            since: episode.episode,
            changes: Vec::new(),
        });
        if before != Some(after) {
            let episode = *episode;
            history.changes.push(PredictionChange {
                episode,
                before,
                after,
            });
        }
        ControlFlow::Continue(())
    }
}
