//! How rules are taught on a map: what they may look at, what they are to cover, and how they are put to
//! the test.

use super::context::View;
use super::induction::induce;
use super::lessons::{Lessons, Taken, imagine};
use super::map::Map;
use super::rehearsal::rehearse;
use crate::agent::model::pomdp::BeliefPlanner;
use xcs::random::Stream;
use xcs::{Action, Percept, Population};

/// How often rules are put to the test on the map, and learn from what they met.
const LESSONS: usize = 6;
/// Where moves slip, an action is good if it costs at most so many steps more than the best, and a
/// context counts if it came so often.
const TOLERANCE: f64 = 0.1;
const LEAST_OFTEN: f64 = 4.5;
/// Where they do not, costs that differ by less are equal.
const EXACT: f64 = 1e-6;
/// Rules look at more if more than this share of their steps is lost without it, where moves slip or
/// cells are misread.
const NEEDED: f64 = 0.03;
/// Imagined episodes of a test, if moves slip or cells are misread.
const TESTS: u32 = 300;
/// Imagined episodes of a test from each state, if they do not: chance decides between actions that
/// the rules hold for equally good, as it does when they act.
const TESTS_OF_TIES: u32 = 8;

/// How rules that look at so much are induced on a map, and put to the test.
pub struct Course<'a> {
    map: &'a Map,
    view: View,
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
    /// The course on this map.
    pub fn on(map: &'a Map, view: View) -> Self {
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
            slips,
            planned,
            tests,
            tolerance,
            least_often,
            tolerated,
        }
    }

    /// Rules induced from imagined episodes, put to the test, and improved by what they met; and the
    /// last test, or the best if moves are exact.
    pub fn induced(&self, planner: &mut BeliefPlanner, stream: &mut Stream) -> (Population, Taken) {
        let mut lessons = Lessons::new();
        self.plan(planner, stream, &mut lessons);
        let mut best: Option<(Population, Taken)> = None;
        for _ in 0..LESSONS {
            let actions = self.map.pomdp.actions();
            let induced = induce(&lessons, actions, self.tolerance, self.least_often);
            let rules: Population = induced.try_into().expect("induced rules are sound");
            let before = lessons.len();
            let test = self.test(&rules, planner, stream, &mut lessons);
            // Where moves slip a test is a matter of luck, and the last rules have learned most.
            let better = |(_, least): &(_, Taken)| test.lost <= least.lost;
            if self.slips || best.as_ref().is_none_or(better) {
                best = Some((rules, test));
            }
            if lessons.len() == before {
                break;
            }
        }
        best.unwrap_or_default()
    }

    /// What rules take where cells are misread as often as they are; nothing, if they never are.
    pub fn rehearsed(
        &self,
        rules: &Population,
        planner: &BeliefPlanner,
        mut stream: Stream,
    ) -> Taken {
        match self.map.misread > 0.0 {
            true => rehearse(self.map, planner, rules, TESTS, &mut stream),
            false => Taken::default(),
        }
    }

    /// Are rules good enough that lost so much?
    pub fn tolerates(&self, test: Taken, rehearsal: Taken) -> bool {
        test.share_lost() <= self.tolerated && rehearsal.share_lost() <= NEEDED
    }

    /// Imagines episodes from each state, as planned.
    fn plan(&self, planner: &mut BeliefPlanner, stream: &mut Stream, lessons: &mut Lessons) {
        let rounds = self.planned;
        self.imagine(rounds, |_, _| None, planner, stream, lessons);
    }

    /// Imagines episodes from each state, with actions that the rules choose.
    fn test(
        &self,
        rules: &Population,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
        lessons: &mut Lessons,
    ) -> Taken {
        let chosen = |context: &Percept, stream: &mut Stream| {
            let worth = rules.sums(context).array(self.map.pomdp.actions(), false);
            let mut best = worth.best_actions();
            match self.slips {
                true => best.next(),
                false => stream.choose(&best.collect::<Vec<_>>()).copied(),
            }
        };
        self.imagine(self.tests, chosen, planner, stream, lessons)
    }

    fn imagine(
        &self,
        rounds: u32,
        chosen: impl Fn(&Percept, &mut Stream) -> Option<Action>,
        planner: &mut BeliefPlanner,
        stream: &mut Stream,
        lessons: &mut Lessons,
    ) -> Taken {
        let starts = (0..rounds).flat_map(|_| 0..self.map.starts());
        let look = |context: Percept| self.view.of(&context);
        imagine(self.map, planner, starts, chosen, look, stream, lessons)
    }
}
