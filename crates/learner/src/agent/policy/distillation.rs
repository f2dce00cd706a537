//! How rules are corrected on a map: by what was planned, by what they met in imagined episodes and by
//! what they met when they drove.

use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::{PARTS, View};
use crate::agent::explorer::exploit;
use crate::agent::planner::rtdp_bel::BeliefPlanner;
use crate::agent::policy::examples::{Example, Examples, imagine, labelled_examples};
use crate::agent::policy::rollouts::rehearse;
use xcs::random::Stream;
use xcs::{
    Action, Induction, LabelledExample, LabelledExamples, Params, Percept, Population,
    PredictionArray, Record,
};

/// How often rules act on the map, at most, and learn from what they met there, if moves slip and if they do not.
const ROUNDS: usize = 6;
const ROUNDS_OF_EXACT: usize = 20;
/// Where moves slip, an action is good if it costs at most so many steps more than the best, and a
/// context counts if it came so often; where cells are misread, the same when driving.
const TOLERANCE: f64 = 0.1;
const LEAST_OFTEN: f64 = 4.5;
/// Where they do not, costs that differ by less are equal.
const EXACT: f64 = 1e-6;
/// Imagined episodes, if moves slip or cells are misread.
const IMAGINED: u32 = 300;
/// Simulated episodes from each state in which rules act, if they do not: chance decides between
/// actions that the rules hold for equally good, as it does when they drive. On large maps there are fewer,
/// and this many in all.
const SIMULATED_OF_TIES: u32 = 8;
const SIMULATED_OF_LARGE: u32 = 2400;

/// How rules are corrected on a map.
pub struct Distillation<'a> {
    map: &'a Map,
    view: View,
    params: &'a Params,
    observation_error: bool,
    rounds: usize,
    /// Imagined episodes from each state: as planned, and in which rules act.
    planned: u32,
    acted: u32,
    /// By how many steps an action of a example may be worse than the best, and how often its context must come.
    tolerance: f64,
    least_often: f64,
    /// The same when driving.
    allowed: f64,
    least_met: f64,
}

impl<'a> Distillation<'a> {
    /// The course on this map, for a population with these parameters whose rules look at no more than this.
    pub fn on(map: &'a Map, view: View, params: &'a Params) -> Self {
        let slips = map.pomdp.slip() > 0.0;
        let (rounds, planned, acted) = match slips {
            true => {
                let episodes = IMAGINED.div_ceil(map.starts());
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

    /// Did a context come often enough when driving to learn from it?
    pub fn counts(&self, met: &Example) -> bool {
        met.weight >= self.least_met
    }

    /// Is an action right that costs so many steps more than the best?
    pub fn approves(&self, regret: f64) -> bool {
        regret <= self.allowed
    }

    /// Makes rules agree with what was met when driving and with imagined episodes, first as planned, then such
    /// in which they act, until they meet nothing new and agree with all.
    pub fn correct(
        &self,
        rules: &mut Population,
        met: &Examples,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
    ) {
        let mut cases = Examples::new();
        *rules = self.view.part_of(rules);
        self.imagine(self.planned, |_, _| None, planner, stream, &mut cases);
        let mut labelled_examples = self.labelled_examples(&cases, met);
        for _ in 0..self.rounds {
            Induction::in_parts(PARTS, Record::Steps).learn(
                rules,
                &mut labelled_examples,
                self.params,
            );
            let chosen = |context: &Percept, stream: &mut Stream| {
                Some(exploit(&self.values(rules, context), stream))
            };
            let known = cases.len();
            self.imagine(self.acted, chosen, planner, stream, &mut cases);
            labelled_examples = self.labelled_examples(&cases, met);
            let agrees = |labelled_example: &LabelledExample| {
                labelled_example.agrees_with(&self.values(rules, &labelled_example.percept))
            };
            if cases.len() == known
                && labelled_examples
                    .iter()
                    .all(|(_, labelled_example)| agrees(labelled_example))
            {
                break;
            }
        }
    }

    /// The share of their steps that rules lose where cells are misread as often as they are; nothing, if they
    /// never are.
    pub fn lost(&self, rules: &Population, planner: &BeliefPlanner, stream: &mut Stream) -> f64 {
        match self.observation_error {
            true => rehearse(self.map, planner, rules, IMAGINED, stream),
            false => 0.0,
        }
    }

    fn values(&self, rules: &Population, context: &Percept) -> PredictionArray {
        rules.sums(context).array(self.map.pomdp.actions(), false)
    }

    /// The examples of what was imagined and met.
    fn labelled_examples(&self, imagined: &Examples, met: &Examples) -> LabelledExamples {
        let mut cases = imagined.clone();
        for (context, met) in met.iter().filter(|(_, met)| self.counts(met)) {
            let case = cases.entry(self.view.of(context)).or_default();
            *case = case.with(met);
        }
        labelled_examples(
            &cases,
            self.map.pomdp.actions(),
            self.tolerance,
            self.least_often,
        )
    }

    fn imagine(
        &self,
        rounds: u32,
        chosen: impl Fn(&Percept, &mut Stream) -> Option<Action>,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
        cases: &mut Examples,
    ) {
        let starts = (0..rounds).flat_map(|_| 0..self.map.starts());
        imagine(
            self.map,
            planner,
            starts,
            chosen,
            |context| self.view.of(&context),
            stream,
            cases,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::belief::Belief;
    use crate::agent::estimator::map::state_map::{MapState, sight};
    use crate::agent::estimator::map::tracker::{CONTEXT_BITS, Felt, PERCEPT_BITS, Tracker};
    use crate::agent::model::pomdp::{GOAL, Pomdp};

    /// Two places that look different: from the first the one action leads to the goal, from the second the other.
    fn two_places(slip: f64) -> Map {
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

    /// What rules choose that learn from imagined episodes and from one context that was met when driving,
    /// so often, and looks like the first place, but is the second.
    fn chosen_after(met_times: u32, slip: f64) -> Vec<usize> {
        let map = two_places(slip);
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
    fn what_was_met_when_driving_teaches_what_no_imagined_episode_does() {
        assert_eq!(chosen_after(0, 0.0), [0]);
        assert_eq!(chosen_after(1, 0.0), [1]);
    }

    #[test]
    fn where_moves_slip_it_teaches_from_the_fifth_time_on() {
        assert_eq!(chosen_after(4, 0.1), [0]);
        assert_eq!(chosen_after(5, 0.1), [1]);
    }
}
