//! How rules are taught on a map: what they may look at, what is right, and how they are put to the test.

use super::context::View;
use super::lessons::{Cases, Taken, imagine, lessons};
use super::map::Map;
use super::rehearsal::rehearse;
use crate::agent::explorer::exploit;
use crate::agent::model::pomdp::BeliefPlanner;
use xcs::random::Stream;
use xcs::{Action, Induction, Params, Percept, Population};

/// How often rules are put to the test on the map, and learn from what they met.
const ROUNDS: usize = 6;
/// Where moves slip, an action is good if it costs at most so many steps more than the best, and a
/// context counts if it came so often.
const TOLERANCE: f64 = 0.1;
const LEAST_OFTEN: f64 = 4.5;
/// Where they do not, costs that differ by less are equal.
pub const EXACT: f64 = 1e-6;
/// Rules look at more if more than this share of their steps is lost without it, where moves slip or
/// cells are misread.
const NEEDED: f64 = 0.03;
/// Imagined episodes of a test, if moves slip or cells are misread.
const TESTS: u32 = 300;
/// Imagined episodes of a test from each state, if they do not: chance decides between actions that
/// the rules hold for equally good, as it does when they act.
const TESTS_OF_TIES: u32 = 8;

/// How rules that look at so much are taught on a map, and put to the test.
pub struct Course<'a> {
    map: &'a Map,
    view: View,
    params: &'a Params,
    slips: bool,
    /// Imagined episodes from each state: as planned, and in a test.
    planned: u32,
    tests: u32,
    /// By how many steps an action may be worse than the best.
    tolerance: f64,
    least_often: f64,
    /// The share of the steps that rules may lose.
    tolerated: f64,
}

impl<'a> Course<'a> {
    /// The course on this map, for a population with these parameters.
    pub fn on(map: &'a Map, view: View, params: &'a Params) -> Self {
        let slips = map.pomdp.slip() > 0.0;
        let (planned, tests) = match slips {
            true => [TESTS.div_ceil(map.starts()); 2].into(),
            false => (1, TESTS_OF_TIES),
        };
        let (tolerance, least_often, tolerated) = match slips {
            true => (TOLERANCE, LEAST_OFTEN, NEEDED),
            false => (EXACT, 0.0, EXACT),
        };
        Self {
            map,
            view,
            params,
            slips,
            planned,
            tests,
            tolerance,
            least_often,
            tolerated,
        }
    }

    /// The rules of a population that look at no more than this, made to agree with imagined episodes, put
    /// to the test, and corrected by what they met; and the last test, or the best if moves are exact.
    pub fn taken(
        &self,
        before: &Population,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
    ) -> (Population, Taken) {
        let mut rules = self.view.part_of(before);
        let mut cases = Cases::new();
        self.plan(planner, stream, &mut cases);
        let mut best: Option<(Population, Taken)> = None;
        for _ in 0..ROUNDS {
            self.teach(&mut rules, &cases);
            let before = cases.len();
            let test = self.test(&rules, planner, stream, &mut cases);
            // Where moves slip a test is a matter of luck, and the last rules have learned most.
            let better = |(_, least): &(_, Taken)| test.lost <= least.lost;
            if self.slips || best.as_ref().is_none_or(better) {
                best = Some((rules.clone(), test));
            }
            if cases.len() == before {
                break;
            }
        }
        best.unwrap_or_default()
    }

    /// Corrects the rules that are wrong in a case, covers those that none covers, and removes what is
    /// superfluous.
    fn teach(&self, rules: &mut Population, cases: &Cases) {
        let actions = self.map.pomdp.actions();
        let mut lessons = lessons(cases, actions, self.tolerance, self.least_often);
        Induction::default().learn(rules, &mut lessons, self.params);
    }

    /// What rules take where cells are misread as often as they are; nothing, if they never are.
    pub fn rehearsed(
        &self,
        rules: &Population,
        planner: &BeliefPlanner,
        stream: &mut Stream,
    ) -> Taken {
        match self.map.misread > 0.0 {
            true => rehearse(self.map, planner, rules, TESTS, stream),
            false => Taken::default(),
        }
    }

    /// Are rules good enough that lost so much?
    pub fn tolerates(&self, test: Taken, rehearsal: Taken) -> bool {
        test.share_lost() <= self.tolerated && rehearsal.share_lost() <= NEEDED
    }

    /// Imagines episodes from each state, as planned.
    fn plan(&self, planner: &mut BeliefPlanner, stream: &mut Stream, cases: &mut Cases) {
        let rounds = self.planned;
        self.imagine(rounds, |_, _| None, planner, stream, cases);
    }

    /// Imagines episodes from each state, with actions that the rules choose.
    fn test(
        &self,
        rules: &Population,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
        cases: &mut Cases,
    ) -> Taken {
        let actions = self.map.pomdp.actions();
        let chosen = |context: &Percept, stream: &mut Stream| {
            let worth = rules.sums(context).array(actions, false);
            Some(exploit(&worth, stream))
        };
        self.imagine(self.tests, chosen, planner, stream, cases)
    }

    fn imagine(
        &self,
        rounds: u32,
        chosen: impl Fn(&Percept, &mut Stream) -> Option<Action>,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
        cases: &mut Cases,
    ) -> Taken {
        let starts = (0..rounds).flat_map(|_| 0..self.map.starts());
        let look = |context: Percept| self.view.of(&context);
        imagine(self.map, planner, starts, chosen, look, stream, cases)
    }
}
