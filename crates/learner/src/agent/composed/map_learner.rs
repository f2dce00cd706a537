//! A learner whose state is a cell of a learned map. It distinguishes aliased cells by the robot's path.
//!
//! Maps, motion model and noise model are estimated from the episodes that reached a goal ([`MapSet`]).
//! On the map, the learner tracks a belief about its cell ([`Tracker`]), plans over beliefs
//! ([`BeliefPlanner`]) and simulates episodes. The policy is a set of rules, or the plan itself. The
//! rules are distilled from the simulated decisions and from those made while driving ([`Distillation`]).
//! Frontier exploration ([`LocalMap`]) takes whole episodes, with decreasing frequency.

use crate::agent::estimator::aliasing::Aliasing;
use crate::agent::estimator::map::map_set::MapSet;
use crate::agent::estimator::map::robot_model::MapStep;
use crate::agent::estimator::map::tracker::{Felt, Tracker};
use crate::agent::estimator::map::{Map, MapParams, Vision};
use crate::agent::knowledge::Knowledge;
use crate::agent::planner::frontier::LocalMap;
use crate::agent::planner::rtdp_bel::BeliefPlanner;
use crate::agent::policy::PolicyKind;
use crate::agent::policy::explorer::Explorer;
use crate::agent::policy::map_rules::MapRules;
use crate::agent::policy::plan::{BeliefPlan, plan_for, planned_values};
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, Params, StepCredit};
use xcs::random::Stream;
use xcs::{Action, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;

/// The number of first episodes that all explore: a single one maps only a path or two to a goal.
const ALL_EXPLORE: u32 = 5;
/// Up to this episode every second one explores, since most maps are incomplete. Later, one in ten does,
/// because a rarely visited cell may still be missing.
const MANY_EXPLORE: u32 = 200;
/// The initial episode number of a learner that starts with rules from another world.
const EXPERIENCED: u32 = 6;

/// Maps, a plan over beliefs about the robot's cell, and a policy.
#[derive(Debug, Clone)]
pub struct MapLearner {
    xcs: xcs::Params,
    params: Params,
    actions: usize,
    learned: Learned,
    /// Derived from the maps.
    map: Map,
    tracker: Tracker,
    /// The steps of this episode.
    steps: Vec<MapStep>,
    /// The current percept.
    percept: Option<Percept>,
}

/// What learning changes.
#[derive(Debug, Clone)]
struct Learned {
    maps: MapSet,
    /// Evidence from the time before the first map.
    aliasing: Aliasing,
    planner: BeliefPlanner,
    /// The rules that choose; `None` if the plan does.
    rules: Option<MapRules>,
    stream: Stream,
    /// The number of finished episodes; more for a learner that started with rules from another world.
    episodes: u32,
    /// True if the plan has changed since the rules were last corrected, or if the rules were wrong.
    stale: bool,
    local: LocalMap,
}

impl MapLearner {
    /// Creates an untrained learner for a number of actions and a kind of vision. `stream` draws
    /// simulated episodes and breaks ties of exploration. The parameters must have been checked.
    pub fn new(
        (actions, vision): (usize, Vision),
        xcs: xcs::Params,
        params: Params,
        own: MapParams,
        (policy, stream): (PolicyKind, Stream),
    ) -> Self {
        Self {
            xcs,
            params,
            actions,
            learned: Learned {
                maps: MapSet::new(actions, vision, own),
                aliasing: Aliasing::default(),
                planner: BeliefPlanner::default(),
                rules: (policy == PolicyKind::Rules).then(MapRules::default),
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

    /// Returns true in an exploration episode.
    fn explores(&self) -> bool {
        let every = match self.learned.episodes {
            0..ALL_EXPLORE => 1,
            ALL_EXPLORE..MANY_EXPLORE => 2,
            _ => 10,
        };
        self.rule_count() == 0 || self.learned.episodes % every == every - 1
    }

    /// Returns the action that leads to the nearest frontier of this episode.
    fn explore(&mut self) -> Action {
        let passes_goals = self.passes_goals();
        let learned = &mut self.learned;
        let (maps, stream) = (&learned.maps, &mut learned.stream);
        let (motion, feels_bumps) = (&maps.robot().motion, maps.feels_bumps());
        let local = &learned.local;
        local.explore(motion, feels_bumps, passes_goals, stream)
    }

    /// Returns true in an exploration episode that passes goals; every second one does. Maps are built
    /// around the goal that was reached, so cells next to another goal would stay missing there.
    fn passes_goals(&self) -> bool {
        let several = self
            .map
            .states
            .last()
            .is_some_and(|map_state| map_state.cell_map > 0);
        several && self.learned.episodes / 2 % 2 == 1
    }

    /// Converts a step to the form from which maps are estimated.
    fn map_step(&self, percept: &Percept, action: Action, outcome: Outcome) -> MapStep {
        let maps = &self.learned.maps;
        MapStep {
            around: maps.robot().vision.around(percept),
            action,
            found: outcome.found(),
            bumped: maps.bumped(Felt::from(outcome)),
        }
    }

    /// Updates the maps with an episode that reached a goal.
    fn learn_map(&mut self, steps: Vec<MapStep>) {
        let learned = &mut self.learned;
        if let Some(last) = steps.last() {
            learned.maps.follow(last, None);
        }
        learned.maps.learn(steps);
        let map = learned.maps.map(&self.params);
        if !map.has_same_states(&self.map) {
            learned.planner = BeliefPlanner::new(&map.pomdp);
            let rules = learned.rules.iter_mut();
            rules.for_each(MapRules::forget_contexts);
            learned.stale = true;
        }
        learned.stale |= (map.observation_error > 0.0) != (self.map.observation_error > 0.0);
        self.map = map;
    }

    /// Plans, and corrects the policy if the plan changed or the rules were wrong.
    fn plan(&mut self) {
        let (map, learned) = (&self.map, &mut self.learned);
        let (planner, rules) = (&mut learned.planner, &mut learned.rules);
        let stream = &mut learned.stream;
        if planner.plan(map, learned.episodes, stream) {
            learned.stale = true;
            if map.pomdp.slip() == 0.0 {
                rules.iter_mut().for_each(MapRules::forget_contexts);
            }
        }
        if std::mem::take(&mut learned.stale) {
            match rules {
                Some(rules) => rules.distil(map, planner, &self.xcs, stream),
                None => planner.settle_all(map),
            }
        }
    }

    /// Returns the policy's action values for a belief and the latest steps.
    fn values_of(&self, tracker: &Tracker) -> PredictionArray {
        let (map, actions) = (&self.map, self.actions);
        match &self.learned.rules {
            Some(rules) => rules.values(&tracker.context(map), actions),
            None => planned_values(&self.learned.planner, map, tracker, actions),
        }
    }

    /// Records an action of the rules. Wrong rules are corrected at the end of the episode.
    fn record(&mut self, action: Action) {
        let explores = self.explores();
        let learned = &mut self.learned;
        if let Some(rules) = learned.rules.as_mut().filter(|_| !explores) {
            let situation = (&self.map, &self.tracker);
            learned.stale |= rules.meet(situation, action, &mut learned.planner, &self.xcs);
        }
    }

    /// Learns from a step and the next percept (`None` at a goal) whether several cells share a percept.
    /// Returns `true` once that is certain.
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

    /// Counts the cells in which successive percepts of an episode differ. Returns `true` once
    /// observation errors are too frequent to treat the percept as the state.
    pub fn notices_noise(&mut self, steps: &[(Percept, Action, Outcome)]) -> bool {
        let steps = steps.iter();
        let steps =
            steps.map(|(percept, action, outcome)| self.map_step(percept, *action, *outcome));
        let steps: Vec<MapStep> = steps.collect();
        self.learned.maps.notices_noise(&steps)
    }
}

impl Agent for MapLearner {
    /// Updates the belief about the robot's cell, and returns the policy's action values.
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.tracker.perceive(&self.map, percept);
        let learned = &mut self.learned;
        let around = learned.maps.robot().vision.around(percept);
        let last = self.steps.last();
        if let Some(last) = last {
            learned.maps.follow(last, Some(&around));
        }
        learned.local.perceive(last, &around, learned.maps.robot());
        if learned.rules.is_none() {
            plan_for(&mut learned.planner, &self.map, &self.tracker);
        }
        self.values_of(&self.tracker)
    }

    /// Explores in exploration episodes, and if the policy has no values. Otherwise the policy chooses.
    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if self.explores() || values.greatest().is_none() {
            return Choice::new(self.explore(), DecisionSource::Planner);
        }
        let source = match self.learned.rules {
            Some(_) => DecisionSource::Rules,
            None => DecisionSource::Table,
        };
        Choice::new(explorer.exploit(values), source)
    }

    /// Records the outcome of the action chosen after the last [`observe`](Self::observe).
    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let percept = self.percept.expect("`observe` comes before `update`");
        let rules = self.learned.rules.as_ref();
        let credit = rules.map(|rules| rules.credit(&self.tracker.context(&self.map), action));
        let credit = StepCredit {
            short_term_reward: self.params.short_term(outcome),
            ..credit.unwrap_or_default()
        };
        self.record(action);
        self.tracker.act(action, outcome.into());
        self.steps.push(self.map_step(&percept, action, outcome));
        credit
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.learned.episodes = self.learned.episodes.saturating_add(1);
        let steps = std::mem::take(&mut self.steps);
        self.tracker = Tracker::default();
        self.learned.local.end();
        if reached_goal && !steps.is_empty() {
            self.learn_map(steps);
        }
        if !self.map.states.is_empty() {
            self.plan();
        }
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        EndCredit::new(long_term_reward, 1.0)
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.values_of(&Tracker::at_start(&self.map, percept))
    }

    fn knowledge(&self) -> Knowledge {
        let map = self.map.clone();
        match &self.learned.rules {
            Some(rules) => Knowledge::MapRules {
                rules: rules.rules().clone(),
                map,
            },
            None => {
                let planner = self.learned.planner.clone();
                Knowledge::Planned(BeliefPlan { map, planner })
            }
        }
    }

    /// Starts from rules and maps of another world. Returns `false` if the plan is the policy: it is not
    /// transferred. With an unknown motion model, the rules are useless, and the maps help only later.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        let learned = &mut self.learned;
        let (Some(own), Knowledge::MapRules { rules, map }) = (&mut learned.rules, knowledge)
        else {
            return false;
        };
        learned.maps.warm_start(map);
        self.map = learned.maps.map(&self.params);
        learned.planner = BeliefPlanner::new(&self.map.pomdp);
        if learned.maps.robot().motion.are_certain() {
            *own = MapRules::start_from(rules);
            learned.episodes = EXPERIENCED;
            // The rules may be wrong here.
            learned.stale = true;
        }
        true
    }

    fn remembers(&self) -> bool {
        true
    }

    /// Returns the number of rules, or of beliefs in the plan.
    fn rule_count(&self) -> usize {
        match &self.learned.rules {
            Some(rules) => rules.rules().len(),
            None => self.learned.planner.beliefs(),
        }
    }
}
