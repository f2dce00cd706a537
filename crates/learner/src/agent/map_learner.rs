//! A learner whose state is a cell of a map that it draws itself: percepts that several cells share are told apart
//! by where the robot has come from.
//!
//! Maps, motion model and noise model are estimated from the episodes that reached a goal ([`MapSet`]). On the map, the
//! learner tracks a belief about its cell ([`Tracker`]), plans over beliefs ([`BeliefPlanner`]) and simulates episodes.
//! The policy is a set of rules that are distilled from the simulated decisions and from those met when driving
//! ([`Distillation`]), or the plan itself. Frontier exploration ([`LocalMap`]) acts in whole episodes, which get rarer.

mod policy;

use serde::{Deserialize, Serialize};

use super::estimator::aliasing::Aliasing;
use super::estimator::map::association::MapStep;
use super::estimator::map::map_set::MapSet;
use super::estimator::map::tracker::{CONTEXT_BITS, Felt, Tracker};
use super::estimator::map::{Map, MapParams, RewardScale, Vision};
use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::planner::frontier::LocalMap;
use super::planner::rtdp_bel::{BeliefPlanner, Effort};
use super::policy::PolicyKind;
use super::policy::examples::Examples;
use super::policy::plan::{BeliefPlan, plan_for};
use super::saved::{self, RestoreError};
use super::{Choice, Chooser, EndCredit, Params, StepCredit};
use xcs::random::Stream;
use xcs::{Action, Classifier, Percept, Population, PredictionArray};
use xcscr_robot::arena::Outcome;

/// The most episodes that are simulated after each real one, and the most states that are weighed in them, early and later.
const SIMULATED: usize = 32;
const WEIGHED: [usize; 2] = [1600, 500];
/// Episodes up to which the greater of these holds.
const EARLY: u32 = 100;
/// The first episodes all explore: one alone maps only a path or two to a goal.
const ALL_EXPLORE: u32 = 5;
/// Up to here every second episode explores, since most maps still miss something. Later one in ten does, because a
/// cell that is seldom visited may still be missing.
const MANY_EXPLORE: u32 = 200;
/// A learner that starts with rules from another world explores as after so many episodes.
const EXPERIENCED: u32 = 6;
/// The most simulated episodes from every state after each real one, if moves are exact.
const SWEEPS: usize = 8;
/// Rules may lose this share of their steps to observation errors without looking at more of the context.
const TOLERATED: f64 = 0.03;
/// If moves slip, plans never settle; rules are distilled again after so many episodes.
const REVISED_AFTER: [u32; 14] = [
    25, 50, 75, 100, 150, 200, 250, 300, 400, 500, 600, 700, 800, 900,
];

/// Maps, a plan over beliefs about the own cell, and a policy.
#[derive(Debug, Clone)]
pub struct MapLearner {
    policy: PolicyKind,
    xcs: xcs::Params,
    params: Params,
    actions: usize,
    values: RewardScale,
    learned: Learned,
    /// Follows from the maps.
    map: Map,
    tracker: Tracker,
    /// The steps of this episode.
    steps: Vec<MapStep>,
    /// The current percept.
    percept: Option<Percept>,
}

/// What learning changes. It is saved as it is.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Learned {
    maps: MapSet,
    /// Evidence from the time before maps were drawn.
    aliasing: Aliasing,
    planner: BeliefPlanner,
    rules: Population,
    /// What was met when nothing was explored, since the maps or, where moves are exact, the plan changed last.
    met: Examples,
    stream: Stream,
    /// Finished episodes; more for a learner that started with rules from another world.
    episodes: u32,
    /// Has the plan changed since the rules were corrected, or have they erred?
    stale: bool,
    local: LocalMap,
}

impl Learned {
    /// Can a learner with so many actions, and rules or none, have learned this?
    fn is_valid(&self, actions: usize, has_rules: bool) -> bool {
        let fits = |rule: &Classifier| {
            rule.condition.width() == CONTEXT_BITS && rule.action.index() < actions
        };
        let mut met = self.met.iter();
        self.maps.is_sound(actions)
            && self.local.is_sound()
            && met.all(|(context, met)| context.width() == CONTEXT_BITS && met.is_sound())
            && (has_rules || self.rules.is_empty())
            && self.rules.rules().iter().all(fits)
    }
}

impl MapLearner {
    /// Creates an untrained learner for a number of actions and a way of seeing; `stream` draws simulated episodes and
    /// ties of exploration. The parameters must have been checked.
    pub fn new(
        (actions, vision): (usize, Vision),
        xcs: xcs::Params,
        params: Params,
        own: MapParams,
        (policy, stream): (PolicyKind, Stream),
    ) -> Self {
        let Params {
            goal, step, gamma, ..
        } = params;
        Self {
            policy,
            xcs,
            params,
            actions,
            values: RewardScale { goal, step, gamma },
            learned: Learned {
                maps: MapSet::new(actions, vision, own),
                aliasing: Aliasing::default(),
                planner: BeliefPlanner::default(),
                rules: Population::default(),
                met: Examples::new(),
                stream,
                episodes: 0,
                stale: false,
                local: LocalMap::default(),
            },
            map: Map::default(),
            tracker: Tracker::default(),
            steps: Vec::new(),
            percept: None,
        }
    }

    /// Updates the belief about the own cell, and returns the policy's action values.
    pub fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.tracker.perceive(&self.map, percept);
        let Learned {
            maps,
            local,
            planner,
            ..
        } = &mut self.learned;
        let around = maps.robot().vision.around(percept);
        let last = self.steps.last();
        if let Some(last) = last {
            maps.follow(last, Some(&around));
        }
        local.perceive(last, &around, maps.robot());
        if self.policy == PolicyKind::Plan {
            plan_for(planner, &self.map, &self.tracker);
        }
        self.values_of(&self.tracker)
    }

    /// Explores in whole episodes, which get rarer, and where the policy says nothing; else the policy chooses.
    pub fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if self.explores() || values.greatest().is_none() {
            return Choice::new(self.explore(), Chooser::Planner);
        }
        let chooser = match self.policy {
            PolicyKind::Rules => Chooser::Rules,
            PolicyKind::Plan => Chooser::Table,
        };
        Choice::new(explorer.exploit(values), chooser)
    }

    /// Is this an exploring episode?
    fn explores(&self) -> bool {
        let every = match self.learned.episodes {
            0..ALL_EXPLORE => 1,
            ALL_EXPLORE..MANY_EXPLORE => 2,
            _ => 10,
        };
        self.size() == 0 || self.learned.episodes % every == every - 1
    }

    /// The action that leads to the nearest frontier of this episode.
    fn explore(&mut self) -> Action {
        let passes_goals = self.passes_goals();
        let Learned {
            maps,
            local,
            stream,
            ..
        } = &mut self.learned;
        local.explore(
            &maps.robot().motion,
            maps.feels_bumps(),
            passes_goals,
            stream,
        )
    }

    /// Is this an exploring episode in which to walk past goals? Maps are drawn around the goal that was
    /// reached, and cells next to another would stay missing there. Every second exploring episode is one.
    fn passes_goals(&self) -> bool {
        let several = self
            .map
            .states
            .last()
            .is_some_and(|map_state| map_state.cell_map > 0);
        several && self.learned.episodes / 2 % 2 == 1
    }

    /// Notes the outcome of the action chosen after the last [`observe`](Self::observe). Rules that were wrong are
    /// corrected when the episode ends.
    pub fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let percept = self.percept.expect("`observe` comes before `update`");
        let mut credit = self.matching(action);
        credit.short_term_reward = self.params.short_term(outcome);
        self.learned.stale |= self.meet(action);
        self.tracker.act(action, outcome.into());
        self.steps.push(self.map_step(&percept, action, outcome));
        credit
    }

    /// A step as maps are drawn from it.
    fn map_step(&self, percept: &Percept, action: Action, outcome: Outcome) -> MapStep {
        let maps = &self.learned.maps;
        MapStep {
            around: maps.robot().vision.around(percept),
            action,
            found: outcome.found(),
            bumped: maps.bumped(Felt::from(outcome)),
        }
    }

    /// Ends the episode: corrects maps, plan and policy.
    pub fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.learned.episodes = self.learned.episodes.saturating_add(1);
        let steps = std::mem::take(&mut self.steps);
        self.tracker = Tracker::default();
        self.learned.local.end();
        if reached_goal && !steps.is_empty() {
            self.learn_map(steps);
        }
        if !self.map.states.is_empty() {
            self.learned.stale |= self.plan();
            if std::mem::take(&mut self.learned.stale) {
                match self.policy {
                    PolicyKind::Rules => self.distil(),
                    PolicyKind::Plan => self.settle(),
                }
            }
        }
        EndCredit {
            long_term_reward: if reached_goal { self.params.goal } else { 0.0 },
            learning_rate: 1.0,
            imprinted: false,
        }
    }

    /// Corrects the maps by an episode that reached a goal.
    fn learn_map(&mut self, steps: Vec<MapStep>) {
        let learned = &mut self.learned;
        if let Some(last) = steps.last() {
            learned.maps.follow(last, None);
        }
        learned.maps.learn(steps);
        let map = learned.maps.map(&self.values);
        if !map.is_of_the_same(&self.map) {
            learned.planner = BeliefPlanner::new(&map.pomdp);
            learned.met.clear();
            learned.stale = true;
        }
        learned.stale |= (map.observation_error > 0.0) != (self.map.observation_error > 0.0);
        self.map = map;
    }

    /// Simulates episodes to plan; true if that changed the plan.
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
                let effort = self.simulate(start);
                change = change.max(effort.change);
            }
            if change < 1e-9 {
                break;
            }
            self.learned.met.clear();
            changed = true;
        }
        changed
    }

    /// From states drawn by chance.
    fn plan_by_chance(&mut self) -> bool {
        let states = self.map.starts() as usize;
        let budget = WEIGHED[usize::from(self.learned.episodes > EARLY)];
        let mut weighed = 0;
        for _ in 0..SIMULATED {
            let start = self.learned.stream.below(states) as u32;
            weighed += self.simulate(start).weighed;
            if weighed > budget {
                break;
            }
        }
        REVISED_AFTER.contains(&self.learned.episodes)
    }

    fn simulate(&mut self, start: u32) -> Effort {
        let belief = self.map.first_belief(start);
        let Learned {
            planner, stream, ..
        } = &mut self.learned;
        planner.imagine(&self.map.pomdp, start, belief, stream)
    }

    /// Learns from a step and the percept after it, `None` at a goal, whether several cells share a percept; `true` once
    /// that is certain.
    pub fn notices_aliasing(
        &mut self,
        (percept, action, outcome): (&Percept, Action, Outcome),
        next: Option<&Percept>,
    ) -> bool {
        let step = self.map_step(percept, action, outcome);
        let Learned { maps, aliasing, .. } = &mut self.learned;
        aliasing.learn(percept, &step, next, maps.robot());
        aliasing.is_certain()
    }

    /// Counts cells that successive percepts of an episode show differently; `true` once observation errors are so
    /// frequent that a percept cannot be taken for the state.
    pub fn notices_noise(&mut self, steps: &[(Percept, Action, Outcome)]) -> bool {
        let steps = steps.iter();
        let steps =
            steps.map(|(percept, action, outcome)| self.map_step(percept, *action, *outcome));
        let steps: Vec<MapStep> = steps.collect();
        self.learned.maps.notices_noise(&steps)
    }

    /// What was learned so far.
    pub fn knowledge(&self) -> Knowledge {
        let map = self.map.clone();
        match self.policy {
            PolicyKind::Rules => Knowledge::Remembering {
                rules: self.learned.rules.clone(),
                map,
            },
            PolicyKind::Plan => {
                Knowledge::Planned(BeliefPlan::new(map, self.learned.planner.clone()))
            }
        }
    }

    /// Starts from rules and maps of another world; `false` where the plan is the policy, which is not taken over. Where
    /// the motion model is unknown, such rules are of no use, and maps only later.
    pub fn warm_start(&mut self, rules: &Population, map: &Map) -> bool {
        if self.policy == PolicyKind::Plan {
            return false;
        }
        let learned = &mut self.learned;
        learned.maps.bring(map);
        self.map = learned.maps.map(&self.values);
        learned.planner = BeliefPlanner::new(&self.map.pomdp);
        if learned.maps.robot().motion.are_certain() {
            learned.rules = rules.without_records();
            learned.episodes = EXPERIENCED;
            // They may be wrong here.
            learned.stale = true;
        }
        true
    }

    /// The number of rules, or of beliefs that were planned for.
    pub fn size(&self) -> usize {
        match self.policy {
            PolicyKind::Rules => self.learned.rules.len(),
            PolicyKind::Plan => self.learned.planner.beliefs(),
        }
    }

    /// What learning has changed, as bytes for [`resume`](Self::resume).
    pub fn checkpoint(&self) -> Vec<u8> {
        saved::bytes_of(&self.learned)
    }

    /// Resumes from [`checkpoint`](Self::checkpoint); `false` if that was made with other settings.
    ///
    /// # Errors
    /// When the bytes are damaged.
    pub fn resume(&mut self, saved: &[u8]) -> Result<bool, RestoreError> {
        let mut learned: Learned = saved::read(saved)?;
        if !learned.is_valid(self.actions, self.policy == PolicyKind::Rules) {
            return Ok(false);
        }
        learned.maps = learned.maps.with_settings_of(&self.learned.maps);
        self.map = learned.maps.map(&self.values);
        self.learned = learned;
        Ok(self.learned.planner.belongs_to(&self.map.pomdp))
    }
}
