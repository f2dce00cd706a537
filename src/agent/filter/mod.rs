//! A filter between percepts and a learner: what is likely misread is taken for what it should be.
//!
//! It knows the places in which the robot was, by what they look like, and what came of each action
//! there ([`places`](super::places)). A belief over them explains an unlikely percept as misread before
//! it becomes a new place, and the learner perceives what should be seen in the likeliest place. What
//! was perceived and done is remembered ([`history`]): when later steps tell that a place was mistaken,
//! the learner is taught anew, from nothing, by the history as it is understood now. So it works for
//! every method.
//!
//! As long as nothing tells that percepts are misread, they pass unchanged. That a robot bumped, and so
//! stands where it was, is felt; nothing else is built in.

mod history;

use history::{Felt, History};

use serde::{Deserialize, Serialize};

use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::memory::{self, MemoryError};
use super::places::{Belief, Came};
use super::{Agent, Choice, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::{Action, Percept, PredictionArray};

/// A pair that was tried so often has nothing new to tell.
const FAMILIAR: u32 = 20;
/// Odd steps after which all is looked through for evidence that percepts are misread, at first.
const FIRST_LOOK: u32 = 3;
/// Doubtful steps after which all is settled anew within an episode: so many, or one of so many that are
/// remembered, so that the work grows no faster than what is done.
const DOUBTS: usize = 6;
const SHARE_OF_DOUBTS: usize = 16;
/// At the end of an episode so many fewer suffice.
const FEWER_AT_AN_END: usize = 32;

/// A learner whose percepts are filtered.
pub struct Filtered {
    learner: Box<dyn Agent>,
    /// The learner that knows nothing, and what it begins with.
    unlearned: Box<dyn Agent>,
    first: Vec<u8>,
    actions: usize,
    /// Steps that are remembered at most.
    most: usize,
    state: State,
    belief: Belief,
    /// The first step of this episode.
    begun: usize,
}

/// What the filter keeps from one episode to the next.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct State {
    /// Are percepts filtered?
    doubts: bool,
    /// Were there more steps than are remembered? Then nothing is settled anew.
    full: bool,
    history: History,
    /// Odd steps, and after how many of them is looked for evidence next.
    odd: u32,
    look: u32,
    /// Doubtful steps since all was settled.
    doubtful: u32,
}

impl Filtered {
    /// Filters what a learner perceives, which is made by `learner` and remembers at most so many steps.
    pub fn new(learner: impl Fn() -> Box<dyn Agent>, actions: usize, most: u32) -> Self {
        let (learner, unlearned) = (learner(), learner());
        Self {
            first: learner.memory(),
            learner,
            unlearned,
            actions,
            most: most as usize,
            state: State {
                look: FIRST_LOOK,
                ..State::default()
            },
            belief: Belief::default(),
            begun: 0,
        }
    }

    /// Where the robot is.
    fn locate(&mut self, seen: &Percept) -> usize {
        let places = &mut self.state.history.places;
        let place = match self.state.doubts {
            true => self.belief.perceive(places, seen),
            false => None,
        };
        place.unwrap_or_else(|| places.meet(seen))
    }

    /// Are so many steps in doubt, or odd, that it is time to decide anew where the robot was?
    fn is_due(&self, least: usize, fewer: usize) -> bool {
        let State {
            doubts,
            odd,
            look,
            doubtful,
            history,
            ..
        } = &self.state;
        let share = history.steps.len() / (SHARE_OF_DOUBTS * fewer);
        match doubts {
            true => *doubtful as usize >= least.max(share),
            false => odd >= look,
        }
    }

    /// Decides anew where the robot was; true if that changes anything.
    fn settle(&mut self) -> bool {
        let State {
            doubts,
            full,
            history,
            odd,
            look,
            doubtful,
        } = &mut self.state;
        if *full {
            return false;
        }
        *doubtful = 0;
        if *doubts {
            return history.settle();
        }
        *look = *odd + (*odd / 2).max(2);
        *doubts = history.tells_of_misreading();
        if *doubts {
            history.settle();
        }
        *doubts
    }

    /// Teaches a new learner all that was done, but for what is being done now; gives the last end of
    /// an episode. `ended` tells whether this one has, at the goal or not.
    fn teach_anew(&mut self, ended: Option<bool>) -> Option<EndCredit> {
        let Ok(mut learner) = self.unlearned.restored(&self.first) else {
            return None;
        };
        let History { steps, places } = &self.state.history;
        let mut end = None;
        for (at, step) in steps.iter().enumerate() {
            let Some((action, felt)) = step.done else {
                break;
            };
            if step.begins {
                learner.begin(true);
            }
            learner.consider(places.percept(step.place));
            learner.credit(action, felt.into());
            let is_last = match steps.get(at + 1) {
                Some(next) => next.begins.then_some(felt == Felt::Goal),
                None => ended,
            };
            if let Some(reached_goal) = is_last {
                end = Some(learner.finish(reached_goal));
            }
        }
        self.learner = learner;
        end
    }

    /// Forgets steps that there is no room for.
    fn make_room(&mut self) {
        let State { full, history, .. } = &mut self.state;
        *full |= history.steps.len() > self.most;
        if *full {
            let is_on_the_way = history.steps.len() > self.begun;
            let older = history.steps.len() - usize::from(is_on_the_way);
            history.steps.drain(..older);
            self.begun = 0;
        }
    }

    /// Forgets places that are none.
    fn tidy(&mut self) {
        let State {
            full,
            history,
            doubts,
            ..
        } = &mut self.state;
        if *full {
            history.steps.clear();
        }
        if *doubts {
            history.tidy(self.most);
        }
    }

    /// Does this episode tell nothing that was not known long before?
    fn is_familiar(&self) -> bool {
        let History { steps, places } = &self.state.history;
        steps[self.begun..].iter().all(|step| {
            let tried = |(action, _)| {
                let came = Came::Goal;
                places.tally(step.place, action, came)[1] > FAMILIAR
            };
            step.done.is_none_or(tried)
        })
    }
}

impl Agent for Filtered {
    fn begin(&mut self, evolves: bool) {
        self.begun = self.state.history.steps.len();
        self.belief = Belief::default();
        self.learner.begin(evolves);
    }

    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        self.make_room();
        let place = self.locate(percept);
        let state = &mut self.state;
        let begins = state.history.steps.len() == self.begun;
        let place = state.history.enter(percept, place, begins);
        match state.doubts {
            true => state.doubtful += u32::from(state.history.is_in_doubt()),
            false => state.odd += u32::from(state.history.is_odd()),
        }
        let due = self.is_due(DOUBTS, 1);
        if due && self.settle() {
            self.teach_anew(None);
        }
        let History { steps, places } = &self.state.history;
        let place = steps.last().map_or(place, |step| step.place);
        if !self.state.doubts {
            return self.learner.consider(percept);
        }
        if due {
            self.belief = Belief::at(place);
        }
        self.learner.consider(places.percept(place))
    }

    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        self.learner.choose(worth, explorer)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let felt = Felt::from(outcome);
        self.state.history.act(action, felt);
        self.belief.act(action, felt == Felt::Bumped);
        self.learner.credit(action, outcome)
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let due = self.is_due(1, FEWER_AT_AN_END);
        let anew = (due && self.settle())
            .then(|| self.teach_anew(Some(reached_goal)))
            .flatten();
        if self.is_familiar() {
            self.state.history.steps.truncate(self.begun);
        }
        self.tidy();
        anew.unwrap_or_else(|| self.learner.finish(reached_goal))
    }

    fn step_threshold(&self) -> u32 {
        self.learner.step_threshold()
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.learner.worth(percept)
    }

    fn knowledge(&self) -> Knowledge {
        let of = self.learner.knowledge();
        match self.state.doubts {
            true => Knowledge::Doubting {
                of: Box::new(of),
                places: self.state.history.places.clone(),
            },
            false => of,
        }
    }

    fn bring(&mut self, knowledge: &Knowledge) -> bool {
        let useful = self.learner.bring(knowledge.undoubting());
        self.first = self.learner.memory();
        useful
    }

    fn remembers(&self) -> bool {
        self.learner.remembers()
    }

    fn rule_count(&self) -> usize {
        self.learner.rule_count()
    }

    fn memory(&self) -> Vec<u8> {
        memory::of(&(self.learner.memory(), &self.first, &self.state))
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let (learner, first, state): (Vec<u8>, Vec<u8>, State) = memory::recall(saved)?;
        self.unlearned.restored(&first)?;
        let resumed = Self {
            learner: self.unlearned.restored(&learner)?,
            unlearned: self.unlearned.restored(&self.unlearned.memory())?,
            first,
            actions: self.actions,
            most: self.most,
            begun: state.history.steps.len(),
            state,
            belief: Belief::default(),
        };
        let fits = resumed.state.history.is_sound(self.actions);
        memory::resumed(resumed, fits)
    }
}
