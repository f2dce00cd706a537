//! The loop.

use std::ops::ControlFlow;

use super::observer::{Ending, Episode, Learned, Observer, Step};
use crate::agent::{Agent, Chosen, Explorer};
use xcscr_robot::arena::{Arena, Outcome};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Cell;

/// Runs episode number `number` from `start`: sense, observe, choose, act, update, until a
/// goal is reached or the step-threshold is hit; then the end is credited.
pub fn run(
    number: u32,
    start: Cell,
    arena: &mut dyn Arena,
    sensor: Sensor,
    method: &mut dyn Agent,
    explorer: &mut Explorer,
    observer: &mut dyn Observer,
) -> (Episode, ControlFlow<()>) {
    arena.reset(start);
    observer.began(number, &arena.view());
    let mut tally = Tally::default();
    let ending = loop {
        let cell = arena.view().cell;
        let percept = sensor.perceive(&arena.view());
        let values = method.observe(&percept);
        let choice = method.choose(&values, explorer);
        let action = choice.action;
        let outcome = arena.act(action);
        let credit = method.update(action, outcome);
        let view = arena.view();
        let step = tally.steps + 1;
        let step = Step {
            episode: number,
            step,
            cell,
            percept,
            values,
            action,
            chooser: choice.chooser,
            explored: choice.explores(),
            outcome,
            credit,
            view,
            method: &*method,
        };
        tally.add(&step);
        observer.stepped(&step);
        if outcome == Outcome::ReachedGoal {
            break Ending::Goal;
        }
        if tally.steps >= method.step_threshold() {
            break Ending::StepLimit;
        }
    };
    let end = method.end_episode(ending == Ending::Goal);
    let episode = Episode {
        episode: number,
        ending,
        steps: tally.steps,
        collisions: tally.collisions,
        explored: tally.explored,
        chosen: tally.chosen,
        reward: tally.reward + end.long_term_reward,
        step_threshold: method.step_threshold(),
        learning_rate: end.learning_rate,
        imprinted: end.imprinted,
        rules: method.rule_count(),
    };
    let learned = Learned {
        method,
        sensor,
        view: arena.view(),
    };
    let flow = observer.ended(&episode, &learned);
    (episode, flow)
}

/// What adds up over the steps of an episode.
#[derive(Default)]
struct Tally {
    steps: u32,
    collisions: u32,
    explored: u32,
    chosen: Chosen,
    reward: f64,
}

impl Tally {
    fn add(&mut self, step: &Step<'_>) {
        self.steps += 1;
        self.collisions += u32::from(matches!(step.outcome, Outcome::Collided { .. }));
        self.explored += u32::from(step.explored);
        self.chosen.count(step.chooser);
        self.reward += step.credit.short_term_reward;
    }
}
