//! The procedures of XCS over the population.

use super::classifier::Classifier;
use super::condition::Condition;
use super::ga::{self, Parent};
use super::handles::ClassifierId;
use super::params::Params;
use super::population::Population;
use super::prediction::{PredictionArray, prediction_array};
use super::sets::{ActionSet, MatchSet, Member};
use crate::random::Stream;
use crate::signal::{Action, MAX_ACTIONS, Percept};

/// XCS: a population and the procedures that cover, predict, update and evolve it.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Xcs {
    params: Params,
    actions: usize,
    population: Population,
    /// t: match sets formed so far.
    time: u64,
    stream: Stream,
    /// May the GA run now?
    evolves: bool,
}

impl Xcs {
    /// An empty learner for `actions` actions (1 to [`MAX_ACTIONS`]) that draws from `stream`.
    /// The parameters must have been checked.
    pub fn new(params: Params, actions: usize, stream: Stream) -> Self {
        Self {
            params,
            actions: actions.clamp(1, MAX_ACTIONS),
            population: Population::default(),
            time: 0,
            stream,
            evolves: true,
        }
    }

    /// Lets the GA run from now on, or rest until further notice.
    pub fn let_evolve(&mut self, evolves: bool) {
        self.evolves = evolves;
    }

    /// Starts from rules that were learned before.
    pub fn with_population(mut self, population: Population) -> Self {
        self.population = population;
        self.population
            .delete_surplus(&self.params, &mut self.stream);
        self
    }

    /// \[P\].
    pub fn population(&self) -> &Population {
        &self.population
    }

    /// The parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Forms \[M\] and covers every action that no rule of \[M\] advocates (GENERATE MATCH SET).
    pub fn form_match_set(&mut self, percept: &Percept, set: &mut MatchSet) {
        self.time += 1;
        loop {
            self.collect_matching(percept, set);
            let missing = |action: &Action| !set.covered[action.index()];
            if !Action::all(self.actions).any(|action| missing(&action)) {
                return;
            }
            for action in Action::all(self.actions).filter(missing) {
                self.cover(percept, action);
            }
            // May delete a rule that was just made; then the next round covers again.
            self.population
                .delete_surplus(&self.params, &mut self.stream);
        }
    }

    fn collect_matching(&self, percept: &Percept, set: &mut MatchSet) {
        set.percept = Some(*percept);
        set.members.clear();
        set.micro = 0;
        set.covered = [false; MAX_ACTIONS];
        let MatchSet {
            members,
            micro,
            covered,
            scratch,
            ..
        } = set;
        self.population
            .for_each_match(percept, scratch, |id, rule| {
                members.push(Member {
                    id,
                    action: rule.action,
                });
                *micro += rule.numerosity;
                covered[rule.action.index()] = true;
            });
    }

    fn cover(&mut self, percept: &Percept, action: Action) {
        let condition = Condition::covering(percept, self.params.dont_care, &mut self.stream);
        let rule = Classifier::new(condition, action, self.time, &self.params);
        self.population.insert(rule);
    }

    /// The rules of \[P\] that match a percept and advocate an action, without covering.
    pub fn matching_action_set(&self, percept: &Percept, action: Action) -> ActionSet {
        let mut members = Vec::new();
        self.population
            .for_each_match(percept, &mut Vec::new(), |id, rule| {
                if rule.action == action {
                    members.push(id);
                }
            });
        ActionSet {
            percept: *percept,
            action,
            members,
        }
    }

    /// The prediction array of \[M\] (Eq. 6).
    pub fn predict(&self, set: &MatchSet) -> PredictionArray {
        let rules = set
            .members
            .iter()
            .filter_map(|member| self.population.get(member.id));
        prediction_array(rules, self.actions, self.params.worth_over_match_set)
    }

    /// The prediction array in a percept, read from \[P\] without covering or changing anything.
    pub fn worth(&self, percept: &Percept) -> PredictionArray {
        let mut rules = Vec::new();
        self.population
            .for_each_match(percept, &mut Vec::new(), |_, rule| rules.push(*rule));
        prediction_array(rules.iter(), self.actions, self.params.worth_over_match_set)
    }

    /// Micro-classifiers in a set, and their fitness-weighted mean error.
    pub fn size_and_error(&self, set: &ActionSet) -> (u32, f64) {
        let rules = set.members.iter().filter_map(|&id| self.population.get(id));
        let (micro, error, fitness) = rules.fold((0, 0.0, 0.0), |(micro, error, fitness), rule| {
            (
                micro + rule.numerosity,
                error + rule.error * rule.fitness,
                fitness + rule.fitness,
            )
        });
        (micro, if fitness > 0.0 { error / fitness } else { 0.0 })
    }

    /// Updates the rules of \[A\] toward the payoff `target` at learning rate `beta` (UPDATE SET):
    /// experience, error with the old prediction (Eq. 2), prediction (Eq. 1, whose printed sign
    /// is wrong), set size, fitness; then action-set subsumption.
    pub fn update(&mut self, set: &ActionSet, target: f64, beta: f64) {
        let (micro, _) = self.size_and_error(set);
        for &id in &set.members {
            self.population.modify(id, |rule| {
                rule.experience += 1;
                // Moving average with the mean of all so far while the rule is young.
                let rate = beta.max(1.0 / rule.experience as f64);
                rule.error += rate * ((target - rule.prediction).abs() - rule.error);
                rule.prediction += rate * (target - rule.prediction);
                rule.set_size += rate * (f64::from(micro) - rule.set_size);
            });
        }
        self.update_fitness(set, beta);
        if self.params.action_set_subsumption {
            self.subsume_in_action_set(set);
        }
    }

    /// Fitness moves toward the relative accuracy kappa' (Eq. 4 and 5, which are printed without
    /// numerosities and with a wrong sign).
    fn update_fitness(&mut self, set: &ActionSet, beta: f64) {
        let share = |rule: &Classifier| rule.accuracy(&self.params) * f64::from(rule.numerosity);
        let rules = set.members.iter().filter_map(|&id| self.population.get(id));
        let total: f64 = rules.map(share).sum();
        for &id in &set.members {
            let params = &self.params;
            self.population.modify(id, |rule| {
                let share = rule.accuracy(params) * f64::from(rule.numerosity);
                rule.fitness += beta * (share / total - rule.fitness);
            });
        }
    }

    /// The most general accurate rule of \[A\] takes over the numerosity of all less general ones
    /// (DO ACTION SET SUBSUMPTION).
    fn subsume_in_action_set(&mut self, set: &ActionSet) {
        let rule = |id: &ClassifierId| self.population.get(*id).map(|rule| (*id, rule));
        let able = set.members.iter().filter_map(rule);
        let able = able.filter(|(_, rule)| rule.could_subsume(&self.params));
        let most_general = able.reduce(|best, next| {
            let less_specific = next.1.condition.specificity() < best.1.condition.specificity();
            if less_specific { next } else { best }
        });
        let Some((subsumer, &general)) = most_general else {
            return;
        };
        for &id in set.members.iter().filter(|&&id| id != subsumer) {
            let rule = self.population.get(id);
            if rule.is_some_and(|r| general.condition.is_more_general_than(&r.condition))
                && let Some(absorbed) = self.population.remove(id)
            {
                self.population
                    .modify(subsumer, |rule| rule.numerosity += absorbed.numerosity);
            }
        }
    }

    /// Runs the GA in the niche of \[A\] when its rules have waited long enough (RUN GA).
    pub fn evolve(&mut self, set: &ActionSet) {
        if !(self.params.ga && self.evolves) || !self.is_due(set) {
            return;
        }
        for &id in &set.members {
            self.population
                .modify(id, |rule| rule.time_stamp = self.time);
        }
        let parent = |&id: &ClassifierId| self.population.get(id).map(|rule| (id, *rule));
        let niche: Vec<Parent> = set.members.iter().filter_map(parent).collect();
        let parents = [0; 2].map(|_| ga::select(&niche, &mut self.stream));
        let [Some(mother), Some(father)] = parents else {
            return;
        };
        let parents = [mother, father];
        let (actions, stream) = (self.actions, &mut self.stream);
        for child in ga::children(&parents, &set.percept, actions, &self.params, stream) {
            self.insert_child(child, &parents);
            self.population
                .delete_surplus(&self.params, &mut self.stream);
        }
    }

    /// Have the rules of \[A\] waited longer than theta_GA on average?
    fn is_due(&self, set: &ActionSet) -> bool {
        let rules = set.members.iter().filter_map(|&id| self.population.get(id));
        let (stamps, micro) = rules.fold((0, 0), |(stamps, micro), rule| {
            let numerosity = u64::from(rule.numerosity);
            (stamps + rule.time_stamp * numerosity, micro + numerosity)
        });
        // Multiplied out, so that whole numbers decide.
        micro > 0 && self.time * micro > stamps + u64::from(self.params.theta_ga) * micro
    }

    /// A child that a parent subsumes adds to the parent; any other joins \[P\].
    fn insert_child(&mut self, child: Classifier, parents: &[Parent; 2]) {
        let params = &self.params;
        let subsumes = |(_, rule): &&Parent| params.ga_subsumption && rule.subsumes(&child, params);
        match parents.iter().find(subsumes) {
            Some(&(parent, _)) => self.population.modify(parent, |rule| rule.numerosity += 1),
            None => {
                self.population.insert(child);
            }
        }
    }
}
