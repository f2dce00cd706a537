//! The episode loop.

use std::ops::ControlFlow;

use super::observer::{AfterEpisode, Ending, Episode, Observer, Step};
use crate::agent::{Agent, Chosen, EndCredit, Explorer, Transition};
use xcscr_robot::arena::{Arena, Outcome};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Cell;

/// How an episode starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// The number of the episode, from 1.
    pub episode: u32,
    /// The cell of the robot.
    pub cell: Cell,
    /// True if the GA may discover rules.
    pub evolves: bool,
}

/// Runs an episode: begin, and then for each step perceive, observe, choose, act, update. Ends at a goal
/// or at the step-threshold, and then credits the end.
pub fn run(
    start: Start,
    arena: &mut dyn Arena,
    sensor: Sensor,
    method: &mut dyn Agent,
    explorer: &mut Explorer,
    observer: &mut dyn Observer,
) -> (Episode, ControlFlow<()>) {
    method.begin_episode(start.evolves);
    arena.reset(start.cell);
    observer.began(start.episode, &arena.view());
    let mut totals = Totals::default();
    let mut percept = sensor.perceive(&arena.view());
    let ending = loop {
        let cell = arena.view().cell;
        let values = method.observe(&percept);
        let choice = method.choose(&percept, &values, explorer);
        let action = choice.action;
        let outcome = arena.act(action);
        let is_at_goal = outcome == Outcome::ReachedGoal;
        let next = (!is_at_goal).then(|| sensor.perceive(&arena.view()));
        let credit = method.update(&Transition {
            percept: &percept,
            place: Some(cell),
            action,
            outcome,
            next: next.as_ref(),
        });
        let view = arena.view();
        let step = totals.steps + 1;
        let step = Step {
            episode: start.episode,
            step,
            cell,
            percept,
            values,
            action,
            source: choice.source,
            explored: choice.explores(),
            outcome,
            credit,
            view,
            method: &*method,
        };
        totals.add(&step);
        observer.stepped(&step);
        match next {
            Some(next) => percept = next,
            None => break Ending::Goal,
        }
        if totals.steps >= method.step_threshold() {
            break Ending::StepLimit;
        }
    };
    let end = method.end_episode(ending == Ending::Goal);
    let episode = totals.episode(start.episode, ending, &end, method);
    let after = AfterEpisode {
        method,
        sensor,
        view: arena.view(),
    };
    let flow = observer.ended(&episode, &after);
    (episode, flow)
}

/// Totals over the steps of an episode.
#[derive(Default)]
struct Totals {
    steps: u32,
    collisions: u32,
    explored: u32,
    chosen: Chosen,
    reward: f64,
    filter_firings: u32,
}

impl Totals {
    fn add(&mut self, step: &Step<'_>) {
        self.steps += 1;
        self.collisions += u32::from(matches!(step.outcome, Outcome::Collided { .. }));
        self.explored += u32::from(step.explored);
        self.chosen.count(step.source);
        self.reward += step.credit.short_term_reward;
        self.filter_firings += u32::from(step.credit.filtered.is_some());
    }

    fn episode(&self, number: u32, ending: Ending, end: &EndCredit, method: &dyn Agent) -> Episode {
        Episode {
            episode: number,
            ending,
            steps: self.steps,
            collisions: self.collisions,
            explored: self.explored,
            chosen: self.chosen,
            reward: self.reward + end.long_term_reward,
            step_threshold: method.step_threshold(),
            learning_rate: end.learning_rate,
            filter_firings: self.filter_firings,
            imprinted: end.imprinted,
            rules: method.rule_count(),
        }
    }
}
