//! Distillation of rules on a map: from the plan, from simulated episodes, and from contexts met while driving.
//!
//! Contexts in which the rules act are added to the examples, labelled by the plan, as in DAgger (Ross et al. 2011) and
//! VIPER (Bastani et al. 2018). The rules come from sequential covering (CN2, Clark and Niblett 1989).

use std::collections::BTreeMap;

use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::{PARTS, Tracker, View};
use crate::agent::planner::rtdp_bel::{BeliefPlanner, MOST_SIMULATED_STEPS};
use crate::agent::policy::examples::{Example, Examples, Walker};
use crate::agent::policy::explorer::exploit;
use crate::agent::policy::rollouts::roll_out;
use xcs::random::Stream;
use xcs::{
    Action, Induction, LabelledExample, LabelledExamples, Params, Percept, Population,
    PredictionArray, Record,
};

/// The maximum number of rounds of dataset aggregation, with slipping and with exact moves.
const ROUNDS: usize = 6;
const ROUNDS_OF_EXACT: usize = 20;
/// If moves slip, an action is good if it costs at most this many steps more than the best. A
/// context counts if it was met this often. With observation errors, the same applies to driving.
const TOLERANCE: f64 = 0.1;
const LEAST_OFTEN: f64 = 4.5;
/// With exact moves, costs that differ by less are equal.
const EXACT: f64 = 1e-6;
/// The number of simulated episodes if moves slip or observations have errors.
const SIMULATED: u32 = 300;
/// With exact moves, the number of simulated episodes from each state in which the rules act. Ties between actions
/// are broken at random, as in driving. Large maps get fewer, up to the second number in total.
const SIMULATED_OF_TIES: u32 = 8;
const SIMULATED_OF_LARGE: u32 = 2400;

/// The distillation of rules on a map.
pub struct Distillation<'a> {
    map: &'a Map,
    view: View,
    params: &'a Params,
    observation_error: bool,
    rounds: usize,
    /// Simulated episodes from each state: with the plan acting, and with the rules acting.
    planned: u32,
    acted: u32,
    /// The maximum regret of a good action in steps, and the minimum weight of a context.
    tolerance: f64,
    least_often: f64,
    /// The same for contexts met while driving.
    allowed: f64,
    least_met: f64,
}

impl<'a> Distillation<'a> {
    /// Creates the distillation for a map. `params` are those of the population; the rules see only `view`.
    pub fn on(map: &'a Map, view: View, params: &'a Params) -> Self {
        let slips = map.pomdp.slip() > 0.0;
        let (rounds, planned, acted) = match slips {
            true => {
                let episodes = SIMULATED.div_ceil(map.starts());
                (ROUNDS, episodes, episodes)
            }
            false => {
                let most = SIMULATED_OF_LARGE / map.starts().max(1);
                (ROUNDS_OF_EXACT, 1, most.clamp(1, SIMULATED_OF_TIES))
            }
        };
        let observation_error = map.observation_error > 0.0;
        let (tolerance, least_often) = match slips {
            true => (TOLERANCE, LEAST_OFTEN),
            false => (EXACT, 0.0),
        };
        let (allowed, least_met) = match slips || observation_error {
            true => (TOLERANCE, LEAST_OFTEN),
            false => (EXACT, 0.0),
        };
        Self {
            map,
            view,
            params,
            observation_error,
            rounds,
            planned,
            acted,
            tolerance,
            least_often,
            allowed,
            least_met,
        }
    }

    /// Returns true if a context was met often enough while driving to learn from it.
    pub fn counts(&self, met: &Example) -> bool {
        met.weight >= self.least_met
    }

    /// Returns true if an action with this regret in steps counts as right.
    pub fn approves(&self, regret: f64) -> bool {
        regret <= self.allowed
    }

    /// Distils rules from contexts met while driving and from simulated episodes. The plan acts first, then the rules
    /// act, until they meet no new context and agree with all examples.
    pub fn correct(
        &self,
        rules: &mut Population,
        met: &Examples,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
    ) {
        let mut examples = Examples::new();
        *rules = self.view.part_of(rules);
        self.simulate(self.planned, |_, _| None, planner, stream, &mut examples);
        let mut labelled_examples = self.labelled_examples(&examples, met);
        for _ in 0..self.rounds {
            Induction::in_parts(PARTS, Record::Steps).learn(
                rules,
                &mut labelled_examples,
                self.params,
            );
            let chosen = |context: &Percept, stream: &mut Stream| {
                Some(exploit(&self.values(rules, context), stream))
            };
            let known = examples.len();
            self.simulate(self.acted, chosen, planner, stream, &mut examples);
            labelled_examples = self.labelled_examples(&examples, met);
            let agrees = |labelled_example: &LabelledExample| {
                labelled_example.agrees_with(&self.values(rules, &labelled_example.percept))
            };
            if examples.len() == known
                && labelled_examples
                    .iter()
                    .all(|(_, labelled_example)| agrees(labelled_example))
            {
                break;
            }
        }
    }

    /// Returns the mean regret of the rules per step, in simulated episodes with observation errors; 0 without
    /// observation errors.
    pub fn mean_regret(
        &self,
        rules: &Population,
        planner: &BeliefPlanner,
        stream: &mut Stream,
    ) -> f64 {
        match self.observation_error {
            true => roll_out(self.map, planner, rules, SIMULATED, stream),
            false => 0.0,
        }
    }

    fn values(&self, rules: &Population, context: &Percept) -> PredictionArray {
        rules.sums(context).array(self.map.pomdp.actions(), false)
    }

    /// Returns the labelled examples of the simulated and driven contexts that were met often enough, the most
    /// frequent first.
    fn labelled_examples(&self, simulated: &Examples, met: &Examples) -> LabelledExamples {
        let mut examples = simulated.clone();
        for (context, met) in met.iter().filter(|(_, met)| self.counts(met)) {
            let example = examples.entry(self.view.of(context)).or_default();
            *example = example.with(met);
        }
        let mut often: Vec<_> = examples.into_iter().collect();
        often.retain(|(_, example)| example.weight >= self.least_often);
        often.sort_by(|a, b| b.1.weight.total_cmp(&a.1.weight));
        let actions = self.map.pomdp.actions();
        let mut labelled = LabelledExamples::default();
        for (number, (context, example)) in often.into_iter().enumerate() {
            labelled.give(number, example.labelled(context, actions, self.tolerance));
        }
        labelled
    }

    /// Simulates `rounds` episodes from every start, and adds the contexts met to the examples. The agent acts as
    /// `choose` returns, or by the plan if that is `None`. If moves are exact, each belief met is planned until its
    /// costs converge: wrong rules lead to beliefs that no plan has visited.
    fn simulate(
        &self,
        rounds: u32,
        choose: impl Fn(&Percept, &mut Stream) -> Option<Action>,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
        examples: &mut Examples,
    ) {
        let map = self.map;
        let mut known = BTreeMap::new();
        for start in (0..rounds).flat_map(|_| 0..map.starts()) {
            let mut walker = Walker {
                state: start,
                tracker: Tracker::begun(map.first_belief(start)),
            };
            for _ in 0..MOST_SIMULATED_STEPS {
                let Walker { state, tracker } = &mut walker;
                tracker.perceive_rightly(map, map.pomdp.percept(*state));
                let context = self.view.of(&tracker.context(map));
                let costs = *known
                    .entry(tracker.belief().key())
                    .or_insert_with(|| planner.settled_costs(&map.pomdp, tracker.belief()));
                examples.entry(context).or_default().add(&costs, map);
                let action = choose(&context, stream).unwrap_or_else(|| costs.best());
                if walker.arrives(map, action, stream) {
                    break;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::belief::Belief;
    use crate::agent::estimator::map::state_map::{MapState, sight};
    use crate::agent::estimator::map::tracker::{CONTEXT_BITS, Felt, PERCEPT_BITS};
    use crate::agent::model::pomdp::{GOAL, Pomdp};

    /// Two states with different percepts. From the first, one action leads to the goal; from the second, the other.
    fn two_states(slip: f64) -> Map {
        let seen = [0, 1].map(|bits| sight(&Percept::from_word(bits, PERCEPT_BITS), 0));
        let next = |state: usize, action: Action| match action.index() == state {
            true => GOAL,
            false => state as u32,
        };
        Map {
            pomdp: Pomdp::new(2, slip, &seen, next),
            states: [MapState::default(); 2].into(),
            observation_error: 0.0,
            begin: None,
            unfelt: false,
        }
    }

    /// Returns the actions that rules choose after learning from simulated episodes and from one context that was met
    /// `met_times` times while driving. The context looks like the first state, but is the second.
    fn chosen_after(met_times: u32, slip: f64) -> Vec<usize> {
        let map = two_states(slip);
        let params = Params::default();
        let (mut planner, mut stream) = (BeliefPlanner::new(&map.pomdp), Stream::new(1, 1_u64));
        let costs = planner.settled_costs(&map.pomdp, &Belief::even([1]));
        let mut odd = Tracker::standing(&map, 0);
        let felt = Felt {
            bumped: true,
            rewarded: false,
        };
        odd.act(Action::new(1).unwrap(), felt);
        odd.perceive(&map, &Percept::from_word(0, PERCEPT_BITS));
        let odd = odd.context(&map);
        assert_eq!(odd.width(), CONTEXT_BITS);
        let mut met = Examples::new();
        for _ in 0..met_times {
            met.entry(odd).or_default().add(&costs, &map);
        }
        let mut rules = Population::default();
        Distillation::on(&map, View::Steps, &params).correct(
            &mut rules,
            &met,
            &mut planner,
            &mut stream,
        );
        let values = rules.sums(&odd).array(2, false);
        values.best_actions().map(|action| action.index()).collect()
    }

    #[test]
    fn contexts_met_while_driving_add_examples_that_no_simulated_episode_has() {
        assert_eq!(chosen_after(0, 0.0), [0]);
        assert_eq!(chosen_after(1, 0.0), [1]);
    }

    #[test]
    fn with_slip_a_context_counts_from_the_fifth_time_on() {
        assert_eq!(chosen_after(4, 0.1), [0]);
        assert_eq!(chosen_after(5, 0.1), [1]);
    }
}
