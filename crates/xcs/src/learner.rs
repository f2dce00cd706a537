//! The procedures of XCS over the population.

use super::classifier::Classifier;
use super::condition::Condition;
use super::ga::{self, Parent};
use super::params::{GaClock, Params, RateScope, SubsumerTies, UpdateOrder};
use super::population::Population;
use super::prediction::PredictionArray;
use super::representation::Representation;
use super::sets::{ActionSet, MatchSet};
use crate::action::Action;
use crate::percept::Percept;
use crate::random::Stream;

/// XCS: a population and the procedures that cover, predict, update and evolve it.
#[derive(Debug, Clone, PartialEq)]
pub struct Xcs<C: Representation = Condition> {
    pub(super) params: Params,
    /// The parameters of the representation's operators.
    settings: C::Settings,
    pub(super) actions: usize,
    pub(super) population: Population<C>,
    /// t: match sets formed so far, as [`GaClock`] counts them.
    pub(super) time: u64,
    pub(super) stream: Stream,
    /// True if the GA may run.
    pub(super) evolves: bool,
    /// True if the mapping adapts, as in XCSAM.
    pub(super) adapts: bool,
    /// How often an action set was updated, or a rule taught.
    updates: u64,
}

impl Xcs {
    /// Creates an untrained learner for `actions` actions (1 to
    /// [`MAX_ACTIONS`](crate::MAX_ACTIONS)) that draws from `stream`. The parameters must be valid.
    pub fn new(params: Params, actions: usize, stream: Stream) -> Self {
        Self::with_settings(params, (), actions, stream)
    }

    /// Returns the prediction array for a percept, computed from \[P\] without covering. Changes
    /// nothing.
    pub fn values(&self, percept: &Percept) -> PredictionArray {
        let sums = self.population.sums(percept);
        sums.array(self.actions, self.params.value_over_match_set)
    }
}

impl<C: Representation> Xcs<C> {
    /// Creates an untrained learner with any representation, for `actions` actions (1 to
    /// [`Representation::MAX_ACTIONS`]), that draws from `stream`. The parameters and settings must
    /// be valid.
    pub fn with_settings(
        params: Params,
        settings: C::Settings,
        actions: usize,
        stream: Stream,
    ) -> Self {
        Self {
            params,
            settings,
            actions: actions.clamp(1, C::MAX_ACTIONS),
            population: Population::default(),
            time: 0,
            stream,
            evolves: true,
            adapts: false,
            updates: 0,
        }
    }

    /// Starts from rules learned elsewhere, as if the GA had just run on each of them.
    pub fn start_from(&mut self, rules: &Population<C>) {
        let (time, eam) = (self.time, self.eam_at_first());
        self.population = rules.changed(|rule| (rule.time_stamp, rule.eam) = (time, eam));
        self.population
            .delete_surplus(&self.params, &mut self.stream);
    }

    /// Enables or disables the GA.
    pub fn let_evolve(&mut self, evolves: bool) {
        self.evolves = evolves;
    }

    /// Starts from rules learned earlier.
    pub fn with_population(mut self, population: Population<C>) -> Self {
        self.population = population;
        self.population
            .delete_surplus(&self.params, &mut self.stream);
        self
    }

    /// Returns \[P\].
    pub fn population(&self) -> &Population<C> {
        &self.population
    }

    /// Returns the parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Returns how often an action set was updated, or a rule taught.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// Returns the number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Forms \[M\] and covers every action that no rule of \[M\] advocates (GENERATE MATCH SET).
    /// With an adaptive mapping, covers only as many actions as it requires.
    pub fn form_match_set(&mut self, percept: &C::Percept, set: &mut MatchSet<C>) {
        if self.evolves || self.params.ga_clock == GaClock::AllSteps {
            self.time += 1;
        }
        loop {
            set.clear(percept);
            self.population
                .for_each_match(percept, |id, rule| set.add(id, rule));
            let covers_some = if self.adapts {
                self.cover_by_eam(percept, set)
            } else {
                self.cover_missing(percept, set)
            };
            if !covers_some {
                return;
            }
            // May delete a rule that was just created; the next round then covers again.
            self.population
                .delete_surplus(&self.params, &mut self.stream);
        }
    }

    /// Covers all actions missing from \[M\]; `false` if none is missing.
    fn cover_missing(&mut self, percept: &C::Percept, set: &MatchSet<C>) -> bool {
        let missing = Action::all(self.actions).filter(|&action| !set.covers(action));
        let mut lacks_some = false;
        for action in missing {
            self.cover(percept, action);
            lacks_some = true;
        }
        lacks_some
    }

    pub(super) fn cover(&mut self, percept: &C::Percept, action: Action) {
        let condition = C::covering(percept, &self.params, &self.settings, &mut self.stream);
        let rule = Classifier::new(condition, action, self.time, &self.params);
        let eam = self.eam_at_first();
        self.population.insert(Classifier { eam, ..rule });
    }

    /// Adds an accurate rule that predicts `payoff`, as guided covering does. A rule with the same condition and action
    /// becomes accurate.
    pub fn teach(&mut self, condition: C, action: Action, payoff: f64) {
        let rule = Classifier::new(condition, action, self.time, &self.params);
        let eam = self.eam_at_first();
        self.updates += 1;
        let id = self.population.insert(Classifier { eam, ..rule });
        self.population.modify(id, |rule| {
            (rule.prediction, rule.error, rule.fitness) = (payoff, 0.0, 1.0);
        });
        self.population
            .delete_surplus(&self.params, &mut self.stream);
    }

    /// Returns the rules of \[P\] that match a percept and advocate an action, without covering.
    pub fn matching_action_set(&self, percept: &C::Percept, action: Action) -> ActionSet<C> {
        let mut members = Vec::new();
        self.population.for_each_match(percept, |id, rule| {
            if rule.action == action {
                members.push(id);
            }
        });
        ActionSet {
            percept: percept.clone(),
            action,
            members,
        }
    }

    /// Returns the prediction array of \[M\] (Eq. 6), as of when \[M\] was formed.
    pub fn predict(&self, set: &MatchSet<C>) -> PredictionArray {
        set.sums()
            .array(self.actions, self.params.value_over_match_set)
    }

    /// Returns the value of each action in a percept, in the order of the actions; `None` for an
    /// action that no rule advocates. Computed from \[P\] without covering. Changes nothing.
    pub fn action_values(&self, percept: &C::Percept) -> Vec<Option<f64>> {
        let sums = self.population.sums(percept);
        let value = |action| sums.value(action, self.params.value_over_match_set);
        Action::all(self.actions).map(value).collect()
    }

    /// Returns the fittest rule of a set, which has the largest weight in the value of its action.
    /// Of equally fit rules, returns the first.
    pub fn strongest<'a>(&'a self, set: &'a ActionSet<C>) -> Option<&'a Classifier<C>> {
        let rules = self.population.living(set.members()).map(|(_, rule)| rule);
        rules.reduce(|best, next| {
            if next.fitness > best.fitness {
                next
            } else {
                best
            }
        })
    }

    /// Returns the number of micro-classifiers in a set and their fitness-weighted mean error.
    pub fn size_and_error(&self, set: &ActionSet<C>) -> (u32, f64) {
        let (mut micro, mut error, mut fitness) = (0, 0.0, 0.0);
        for (_, rule) in self.population.living(set.members()) {
            micro += rule.numerosity;
            error += rule.error * rule.fitness;
            fitness += rule.fitness;
        }
        (micro, if fitness > 0.0 { error / fitness } else { 0.0 })
    }

    /// Updates the rules of \[A\] toward the payoff `target` at learning rate `beta` (UPDATE SET), and runs action-set
    /// subsumption.
    pub fn update(&mut self, set: &ActionSet<C>, target: f64, beta: f64) {
        self.update_statistics(set, target, beta);
        if self.params.action_set_subsumption {
            self.subsume_in_action_set(set);
        }
    }

    /// Updates the rules of \[A\] without action-set subsumption.
    ///
    /// Updates experience, then error (Eq. 2) and prediction (Eq. 1, whose printed sign is wrong)
    /// in the order of [`UpdateOrder`], then set size and fitness.
    pub fn update_statistics(&mut self, set: &ActionSet<C>, target: f64, beta: f64) {
        self.updates += 1;
        let micro: u32 = self
            .population
            .living(set.members())
            .map(|(_, rule)| rule.numerosity)
            .sum();
        let params = &self.params;
        let other_beta = match params.rate_scope {
            RateScope::All => beta,
            RateScope::Prediction => params.beta,
        };
        // With extreme settings all accuracies are 0. All rules then have equal weight.
        let accuracy = |rule: &Classifier<C>| rule.accuracy(params).max(f64::MIN_POSITIVE);
        let share = |rule: &Classifier<C>| accuracy(rule) * f64::from(rule.numerosity);
        let mut total = 0.0;
        for &id in &set.members {
            let Some(rule) = self.population.get_mut(id) else {
                continue;
            };
            rule.experience = rule.experience.saturating_add(1);
            let least = match params.mean_while_young {
                true => 1.0 / f64::from(rule.experience),
                false => 0.0,
            };
            let (rate, other_rate) = (beta.max(least), other_beta.max(least));
            let old_prediction = rule.prediction;
            rule.prediction += rate * (target - old_prediction);
            let prediction = match params.update_order {
                UpdateOrder::ErrorFirst => old_prediction,
                UpdateOrder::PredictionFirst => rule.prediction,
            };
            rule.error += other_rate * ((target - prediction).abs() - rule.error);
            rule.set_size += other_rate * (f64::from(micro) - rule.set_size);
            total += share(rule);
        }
        // Fitness moves toward the relative accuracy kappa' (Eq. 4 and 5, which are printed
        // without numerosities and with a wrong sign).
        for &id in &set.members {
            self.population.modify(id, |rule| {
                rule.fitness += other_beta * (share(rule) / total - rule.fitness);
                rule.fitness = rule.fitness.max(f64::MIN_POSITIVE);
            });
        }
    }

    /// Subsumes the less general rules of \[A\] under the most general accurate one, which takes
    /// over their numerosity (DO ACTION SET SUBSUMPTION).
    fn subsume_in_action_set(&mut self, set: &ActionSet<C>) {
        let able = self.population.living(set.members());
        let able = able.filter(|(_, rule)| rule.could_subsume(&self.params));
        let (ties, stream) = (self.params.subsumer_ties, &mut self.stream);
        let most_general = able.reduce(|best, next| {
            let [old, new] = [best, next].map(|(_, rule)| rule.condition.specificity());
            let wins_tie = old == new && ties == SubsumerTies::Random && stream.chance(0.5);
            if new < old || wins_tie { next } else { best }
        });
        let Some((subsumer, general)) = most_general.map(|(id, rule)| (id, rule.condition.clone()))
        else {
            return;
        };
        for &id in set.members.iter().filter(|&&id| id != subsumer) {
            let rule = self.population.get(id);
            if rule.is_some_and(|r| general.is_more_general_than(&r.condition))
                && let Some(absorbed) = self.population.remove(id)
            {
                self.population
                    .modify(subsumer, |rule| rule.numerosity += absorbed.numerosity);
            }
        }
    }

    /// Runs the GA in the niche of \[A\] if its rules have waited long enough (RUN GA).
    pub fn evolve(&mut self, set: &ActionSet<C>) {
        if !(self.params.ga && self.evolves && self.is_due(set)) {
            return;
        }
        for &id in &set.members {
            if let Some(rule) = self.population.get_mut(id) {
                rule.time_stamp = self.time;
            }
        }
        let Some(parents) = self.select_parents(set) else {
            return;
        };
        let (actions, stream) = (self.actions, &mut self.stream);
        let (params, settings) = (&self.params, &self.settings);
        for mut child in ga::children(&parents, &set.percept, actions, params, settings, stream) {
            if child.action != set.action {
                child.eam = self.eam_at_first();
            }
            self.insert_child(child, &parents);
            self.population
                .delete_surplus(&self.params, &mut self.stream);
        }
    }

    /// Selects two rules of \[A\], which may be the same; `None` if all of them were deleted.
    fn select_parents(&mut self, set: &ActionSet<C>) -> Option<[Parent<C>; 2]> {
        let niche = self.population.living(set.members());
        let total = niche.clone().map(|(_, rule)| rule.fitness).sum();
        let mother = ga::select(niche.clone(), total, &mut self.stream);
        let father = ga::select(niche, total, &mut self.stream);
        Some([mother?, father?])
    }

    /// Returns true if the rules of \[A\] have waited longer than theta_GA on average.
    fn is_due(&self, set: &ActionSet<C>) -> bool {
        let (mut stamps, mut micro) = (0, 0);
        for (_, rule) in self.population.living(set.members()) {
            stamps += rule.time_stamp * u64::from(rule.numerosity);
            micro += u64::from(rule.numerosity);
        }
        // Multiplied out, so that the comparison is between integers.
        micro > 0 && self.time * micro > stamps + u64::from(self.params.theta_ga) * micro
    }

    /// Adds a child to \[P\], or to the numerosity of a parent that subsumes it. Inserting the first child may have deleted
    /// a parent, which then subsumes nothing.
    fn insert_child(&mut self, child: Classifier<C>, parents: &[Parent<C>; 2]) {
        let params = &self.params;
        let subsumes = |(id, rule): &&Parent<C>| {
            let is_alive = self.population.get(*id).is_some();
            params.ga_subsumption && is_alive && rule.subsumes(&child, params)
        };
        match parents.iter().find(subsumes) {
            Some(&(parent, _)) => self.population.modify(parent, |rule| rule.numerosity += 1),
            None => {
                self.population.insert(child);
            }
        }
    }
}

#[cfg(test)]
mod tests;
