//! The learner itself: charts, belief and rules.

mod deciding;

pub use deciding::Decider;

use serde::{Deserialize, Serialize};

use super::aliasing::Aliasing;
use super::align::Seen;
use super::atlas::Atlas;
use super::context::{CONTEXT_BITS, Felt, Tracker, View};
use super::course::Course;
use super::lessons::Cases;
use super::map::{Map, Worth};
use super::params::MemoryParams;
use super::place::Vision;
use super::planned::plan_for;
use super::wander::Sketch;
use crate::agent::model::pomdp::{BeliefPlanner, Effort};
use xcs::random::Stream;
use xcs::{Action, Percept};
use xcs::{Classifier, Params, Population, PredictionArray};
use xcscr_robot::arena::Outcome;

/// Imagined episodes after each real one, at most, and the states that may be weighed in them.
const IMAGINED: usize = 32;
const WEIGHED: [usize; 2] = [1600, 500];
/// Episodes up to which the greater of these holds.
const EARLY: u32 = 100;
/// The first episodes all explore: one by itself charts but a way or two to a goal.
const ALL_EXPLORE: u32 = 5;
/// Up to here every second one does, since most charts still miss something, and what acts in the others tells
/// early what they are worth; then one in ten for good, because a place that is seldom come by may be missing yet.
const MANY_EXPLORE: u32 = 200;
/// Who brings rules along explores as after so many episodes.
const EXPERIENCED: u32 = 6;
/// Imagined episodes from every state after each real one, at most, if moves are exact.
const SWEEPS: usize = 8;
/// Rules may lose this share of their steps where cells are misread, without looking at more.
const TOLERATED: f64 = 0.03;
/// If moves slip, plans never settle; rules are taught anew after so many episodes.
const REVISED_AFTER: [u32; 14] = [
    25, 50, 75, 100, 150, 200, 250, 300, 400, 500, 600, 700, 800, 900,
];

/// Charts, what was planned on them, and the rules that learn from it.
#[derive(Debug, Clone)]
pub struct Learner {
    decider: Decider,
    xcs: Params,
    actions: usize,
    worth: Worth,
    atlas: Atlas,
    /// Evidence from the time before maps were drawn.
    aliasing: Aliasing,
    /// Follows from the atlas.
    map: Map,
    planner: BeliefPlanner,
    rules: Population,
    stream: Stream,
    /// Finished episodes; more for one who brought rules along.
    episodes: u32,
    /// What was met when nothing was explored, since the charts or, where moves are exact, the plan changed last.
    met: Cases,
    /// Has the plan changed since the rules were corrected, or have they erred?
    stale: bool,
    tracker: Tracker,
    sketch: Sketch,
    /// The steps of this episode.
    steps: Vec<Seen>,
}

/// What learning changes, but for what follows from the atlas.
#[derive(Debug, Serialize, Deserialize)]
pub struct Kept {
    atlas: Atlas,
    aliasing: Aliasing,
    planner: BeliefPlanner,
    rules: Population,
    met: Cases,
    stream: Stream,
    episodes: u32,
    stale: bool,
    sketch: Sketch,
}

impl Learner {
    /// A learner that knows nothing, for so many actions and who sees like this, the parameters of its
    /// population, and what it is to seek.
    pub fn new(
        (actions, vision): (usize, Vision),
        xcs: Params,
        worth: Worth,
        params: MemoryParams,
        stream: Stream,
    ) -> Self {
        Self {
            xcs,
            decider: Decider::Rules,
            actions,
            worth,
            atlas: Atlas::new(actions, vision, params),
            aliasing: Aliasing::default(),
            map: Map::default(),
            planner: BeliefPlanner::default(),
            rules: Population::default(),
            met: Cases::new(),
            stream,
            episodes: 0,
            stale: false,
            tracker: Tracker::default(),
            sketch: Sketch::default(),
            steps: Vec::new(),
        }
    }

    /// What learning has changed so far.
    pub fn kept(&self) -> Kept {
        Kept {
            atlas: self.atlas.clone(),
            aliasing: self.aliasing.clone(),
            planner: self.planner.clone(),
            rules: self.rules.clone(),
            met: self.met.clone(),
            stream: self.stream.clone(),
            episodes: self.episodes,
            stale: self.stale,
            sketch: self.sketch.clone(),
        }
    }

    /// Goes on from what was kept; `false` if its parts contradict each other.
    pub fn resume(&mut self, kept: Kept) -> bool {
        let fits = |rule: &Classifier| {
            rule.condition.width() == CONTEXT_BITS && rule.action.index() < self.actions
        };
        let drawn = kept.atlas.is_sound(self.actions) && kept.sketch.is_sound();
        let mut met = kept.met.iter();
        let remembers = met.all(|(context, met)| context.width() == CONTEXT_BITS && met.is_sound());
        let decides = self.decider == Decider::Rules || kept.rules.is_empty();
        if !(decides && drawn && remembers && kept.rules.rules().iter().all(fits)) {
            return false;
        }
        self.atlas = kept.atlas.with_settings_of(&self.atlas);
        self.aliasing = kept.aliasing;
        self.map = self.atlas.map(&self.worth);
        self.planner = kept.planner;
        self.rules = kept.rules;
        self.met = kept.met;
        self.stream = kept.stream;
        self.episodes = kept.episodes;
        self.stale = kept.stale;
        self.sketch = kept.sketch;
        self.planner.belongs_to(&self.map.pomdp)
    }

    /// Starts from rules and charts of another world. Where it is not known which way actions go, these
    /// rules are of no use, and the charts only later.
    pub fn bring(&mut self, rules: &Population, map: &Map) {
        self.atlas.bring(map);
        self.map = self.atlas.map(&self.worth);
        self.planner = BeliefPlanner::new(&self.map.pomdp);
        if self.atlas.habits().headings.are_certain() {
            self.rules = rules.without_records();
            self.episodes = EXPERIENCED;
            // They may be wrong here.
            self.stale = true;
        }
    }

    /// The charted places.
    pub fn map(&self) -> &Map {
        &self.map
    }

    /// The rules that act.
    pub fn rules(&self) -> &Population {
        &self.rules
    }

    /// Perceives, and tells what is made of it.
    pub fn perceive(&mut self, percept: &Percept) -> PredictionArray {
        self.tracker.perceive(&self.map, percept);
        let around = self.atlas.habits().vision.around(percept);
        let last = self.steps.last();
        if let Some(last) = last {
            self.atlas.follow(last, Some(&around));
        }
        self.sketch.perceive(last, &around, self.atlas.habits());
        if self.decider == Decider::Plan {
            plan_for(&mut self.planner, &self.map, &self.tracker);
        }
        self.worth(&self.tracker)
    }

    /// Is this an episode in which to look for what is not yet known?
    pub fn explores(&self) -> bool {
        let every = match self.episodes {
            0..ALL_EXPLORE => 1,
            ALL_EXPLORE..MANY_EXPLORE => 2,
            _ => 10,
        };
        self.size() == 0 || self.episodes % every == every - 1
    }

    /// The action that leads to what is not yet known in this episode.
    pub fn explore(&mut self) -> Action {
        let headings = &self.atlas.habits().headings;
        let (feels_bumps, passes_goals) = (self.atlas.feels_bumps(), self.passes_goals());
        self.sketch
            .explore(headings, feels_bumps, passes_goals, &mut self.stream)
    }

    /// Is this an exploring episode in which to walk past goals? Charts are drawn around the goal that was
    /// reached, and what lies beside another would stay missing there. Of those that explore every second.
    fn passes_goals(&self) -> bool {
        let several = self.map.spots.last().is_some_and(|spot| spot.chart > 0);
        several && self.episodes / 2 % 2 == 1
    }

    /// Acts on what was perceived, and bumps or does not, and finds an auxiliary reward or none, 0. Rules that
    /// were wrong are corrected when the episode ends.
    pub fn act(&mut self, percept: &Percept, action: Action, felt: Felt, found: f64) {
        self.stale |= self.meet(action);
        self.tracker.act(action, felt);
        self.steps.push(self.seen(percept, action, felt, found));
    }

    /// Learns from a step and the percept after it, `None` at a goal, whether several cells share a percept; `true` once
    /// that is certain.
    pub fn notices_aliasing(
        &mut self,
        (percept, action, outcome): (&Percept, Action, Outcome),
        next: Option<&Percept>,
    ) -> bool {
        let step = self.seen(percept, action, outcome.into(), outcome.found());
        let habits = self.atlas.habits();
        self.aliasing.learn(percept, &step, next, habits);
        self.aliasing.is_certain()
    }

    /// Counts cells that successive percepts show differently; `true` once observation errors are frequent.
    pub fn notices_noise(&mut self, steps: &[(Percept, Action, Outcome)]) -> bool {
        let seen = steps.iter().map(|(percept, action, outcome)| {
            self.seen(percept, *action, (*outcome).into(), outcome.found())
        });
        let seen: Vec<Seen> = seen.collect();
        self.atlas.notices_noise(&seen)
    }

    /// A step as maps are drawn from it.
    fn seen(&self, percept: &Percept, action: Action, felt: Felt, found: f64) -> Seen {
        Seen {
            around: self.atlas.habits().vision.around(percept),
            action,
            found,
            bumped: self.atlas.bumped(felt),
        }
    }

    /// Ends the episode: learns charts, plan and rules.
    pub fn finish(&mut self, reached_goal: bool) {
        self.episodes = self.episodes.saturating_add(1);
        let steps = std::mem::take(&mut self.steps);
        self.tracker = Tracker::default();
        self.sketch.end();
        if let Some(last) = steps.last().filter(|_| reached_goal) {
            self.atlas.follow(last, None);
            self.atlas.learn(steps);
            let map = self.atlas.map(&self.worth);
            if !map.is_of_the_same(&self.map) {
                self.planner = BeliefPlanner::new(&map.pomdp);
                self.met.clear();
                self.stale = true;
            }
            self.stale |= (map.misread > 0.0) != (self.map.misread > 0.0);
            self.map = map;
        }
        if self.map.spots.is_empty() {
            return;
        }
        self.stale |= self.plan();
        if std::mem::take(&mut self.stale) {
            match self.decider {
                Decider::Rules => self.teach(),
                Decider::Plan => self.settle(),
            }
        }
    }

    /// Imagines episodes to plan; true if that changed the plan.
    fn plan(&mut self) -> bool {
        match self.map.pomdp.slip() > 0.0 {
            true => self.plan_by_chance(),
            false => self.plan_from_everywhere(),
        }
    }

    /// From every state, until nothing changes any more.
    fn plan_from_everywhere(&mut self) -> bool {
        let mut changed = false;
        for _ in 0..SWEEPS {
            let mut change = 0.0_f64;
            for start in 0..self.map.starts() {
                let effort = self.imagine(start);
                change = change.max(effort.change);
            }
            if change < 1e-9 {
                break;
            }
            self.met.clear();
            changed = true;
        }
        changed
    }

    /// From states drawn by chance.
    fn plan_by_chance(&mut self) -> bool {
        let states = self.map.starts() as usize;
        let budget = WEIGHED[usize::from(self.episodes > EARLY)];
        let mut weighed = 0;
        for _ in 0..IMAGINED {
            let start = self.stream.below(states) as u32;
            weighed += self.imagine(start).weighed;
            if weighed > budget {
                break;
            }
        }
        REVISED_AFTER.contains(&self.episodes)
    }

    fn imagine(&mut self, start: u32) -> Effort {
        let belief = self.map.first_belief(start);
        self.planner
            .imagine(&self.map.pomdp, start, belief, &mut self.stream)
    }

    /// Corrects the rules by what was planned and by what they met. Where cells are misread, steps of the window
    /// may come that no imagined episode had: rules look at them only if they lose too much without.
    fn teach(&mut self) {
        let before = std::mem::take(&mut self.rules);
        // Rehearsals draw nothing from what is drawn for learning, and all the same.
        let luck = self.stream.clone();
        let mut least_lost = f64::INFINITY;
        for &view in View::fit_for(&self.map) {
            let course = Course::on(&self.map, view, &self.xcs);
            let mut rules = before.clone();
            let (planner, stream) = (&mut self.planner, &mut self.stream);
            course.correct(&mut rules, &self.met, planner, stream);
            let lost = course.lost(&rules, planner, &mut luck.clone());
            if lost < least_lost {
                (self.rules, least_lost) = (rules, lost);
            }
            if lost <= TOLERATED {
                return;
            }
        }
    }
}
