//! XCSCR-plus: rules decide, and a model teaches them.
//!
//! The rules of \[P\] choose every action that exploits: while it learns, when it is judged, and
//! when it is exported. What an action is worth comes from their prediction array and from nothing
//! else. Behind them stands a model of what followed each action, which never acts where there is
//! nothing to explore. It does two things:
//! * it teaches: `model::known` turns what was tried into lessons (this percept: these actions are the
//!   best), from which rules are discovered by induction ([`xcs::Induction`]);
//! * it explores: `model::exploration` plans the way to an action that promises more than what is known,
//!   foretelling collisions and ways back.
//!
//! The study `repairs` switches each part off in turn.

mod params;

pub use params::PlusParams;

use super::Params;
use super::credit::step_credit;
use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::memory::{self, MemoryError};
use super::model::Foresight;
use super::model::collision_rules::CollisionRules;
use super::model::exploration::{Exploration, Model};
use super::model::known::Known;
use super::model::transitions::{Transition, Transitions};
use super::{Agent, Choice, Chooser, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::random::Stream;
use xcs::{Action, Percept};
use xcs::{Induction, Lessons, MatchSet, Params as XcsParams, PredictionArray, Xcs};

/// The method `xcscr-plus`.
#[derive(Debug, Clone)]
pub struct Plus {
    xcs: Xcs,
    match_set: MatchSet,
    params: Params,
    own: PlusParams,
    memory: Transitions,
    known: Known,
    lessons: Lessons,
    induction: Induction,
    collisions: CollisionRules,
    exploration: Exploration,
    /// Decides between equally promising ways.
    stream: Stream,
    /// The steps of this episode.
    path: Vec<Taken>,
    /// The percept under consideration, and its number.
    present: Option<(Percept, usize)>,
    /// The next step of exploration; `None` where the rules decide.
    heading: Option<Action>,
}

/// A step that was taken.
#[derive(Debug, Clone, Copy)]
struct Taken {
    percept: Percept,
    action: Action,
    reward: f64,
    /// Did it bump? Then what comes after it is known at once.
    bumped: bool,
}

impl Plus {
    /// A learner for `actions` actions and percepts whose first `ring` bits lie in a ring around the
    /// robot. Its rules draw from `evolution` and its plans from `planning`. The parameters must
    /// have been checked.
    pub fn new(
        xcs: XcsParams,
        [actions, ring]: [usize; 2],
        params: Params,
        own: PlusParams,
        [evolution, planning]: [Stream; 2],
    ) -> Self {
        let ring = if own.turned_rules { ring } else { 0 };
        let xcs = XcsParams {
            worth_over_match_set: false,
            ..xcs
        };
        let known = Known::new(actions, &params);
        Self {
            xcs: Xcs::new(xcs, actions, evolution),
            match_set: MatchSet::default(),
            memory: Transitions::default(),
            lessons: Lessons::default(),
            induction: Induction::default(),
            collisions: CollisionRules::new(actions, ring, own.certainty),
            exploration: Exploration::new(actions, &params, known.floor()),
            known,
            stream: planning,
            path: Vec::new(),
            present: None,
            heading: None,
            params,
            own,
        }
    }

    /// Is each lesson about the percept whose number it has?
    fn lessons_are_sound(&self) -> bool {
        let percepts = self.memory.percepts();
        self.lessons.iter().all(|(number, lesson)| {
            percepts.get(number) == Some(&lesson.percept) && lesson.value.is_finite()
        })
    }

    /// Learns the last step, now that it is known what came after it.
    fn learn_last_step(&mut self, next: Option<Percept>) {
        let Some(&Taken {
            percept,
            action,
            reward,
            bumped,
        }) = self.path.last()
        else {
            return;
        };
        self.learn_return(next);
        let number = self.memory.meet(&percept);
        let known = self.memory.is_known(number, action);
        let step = Transition {
            percept,
            action,
            reward,
            next,
        };
        if self.memory.learn(&step, self.memory.slips().lead()) {
            let next = next.map(|next| self.memory.meet(&next));
            self.known.learn(&self.memory, (number, action), next);
        }
        if self.memory.is_known(number, action) != known {
            self.exploration.wake();
        } else if let Some(next) = next.filter(|_| !bumped && self.is_best(number, action)) {
            let next = self.memory.meet(&next);
            if !self.memory.slipped(number, action, next) {
                self.exploration.follow(number, next);
            }
        }
    }

    /// Does a lesson say that an action is one of the best?
    fn is_best(&self, percept: usize, action: Action) -> bool {
        let lesson = self.lessons.get(percept);
        lesson.is_some_and(|lesson| lesson.best[action.index()])
    }

    /// Estimates how often moves slip; if that has changed, all is judged anew.
    fn notice_slips(&mut self) {
        if self.memory.notice_slips(self.params.step) {
            let slips = self.memory.slips();
            self.known.reconsider(&self.memory);
            let margin = if slips.any() { slips.lead() } else { 0 };
            self.collisions.demand(margin);
            self.exploration.wake();
        }
    }

    /// Learns whether the last two steps led there and back.
    fn learn_return(&mut self, next: Option<Percept>) {
        let [.., first, second] = self.path[..] else {
            return;
        };
        if self.own.return_rules && first.percept != second.percept && !second.bumped {
            let back = next == Some(first.percept);
            let turn = [first.action, second.action];
            if self.known.learn_return(&self.memory, turn, back) {
                self.exploration.wake();
            }
        }
    }

    /// Teaches the rules what the model has found out, if there is anything new.
    fn teach(&mut self) {
        for (number, lesson) in self.known.news(&self.memory) {
            self.lessons.give(number, lesson);
        }
        if self.lessons.have_changed() {
            self.xcs.induce(&mut self.induction, &mut self.lessons);
        }
    }

    /// The next step of exploration; `None` where nothing promises more than what is known.
    fn explore(&mut self, number: usize) -> Option<Action> {
        let model = Model {
            memory: &self.memory,
            known: &self.known,
            collisions: &self.collisions,
        };
        match self.own.planned_exploration {
            true => self.exploration.next(number, &model, &mut self.stream),
            false => None,
        }
    }
}

impl Agent for Plus {
    fn begin(&mut self, _: bool) {
        self.exploration.begin();
    }

    /// Learns what the last step led to, decides whether to explore, and asks the rules.
    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        let met = self.memory.percepts().len();
        let number = self.memory.meet(percept);
        if number == met {
            self.exploration.wake();
        }
        self.learn_last_step(Some(*percept));
        self.present = Some((*percept, number));
        self.heading = self.explore(number);
        if self.heading.is_none() {
            self.teach();
        }
        self.xcs
            .match_without_covering(percept, &mut self.match_set);
        self.xcs.predict(&self.match_set)
    }

    /// Where there is nothing to explore the rules choose: one of the actions to which their
    /// prediction array gives the greatest worth, or any where no rule matches.
    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if let Some(action) = self.heading {
            return Choice::new(action, Chooser::Planner);
        }
        let (action, by_chance) = match self.own.planned_exploration {
            true => (explorer.exploit(worth), false),
            false => explorer.choose(worth),
        };
        let by_chance = by_chance || worth.greatest().is_none();
        Choice::of_rules(action, by_chance)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let (percept, _) = self.present.expect("consider comes before credit");
        let reward = self.params.short_term(outcome);
        let set = self.match_set.action_set(action);
        let set = set.expect("consider comes before credit and forms [M]");
        let credit = step_credit(&self.xcs, &self.match_set, &set, reward);
        let bumped = matches!(outcome, Outcome::Collided { .. });
        if self.own.collision_rules && self.collisions.learn(&percept, action, bumped) {
            self.exploration.wake();
        }
        self.path.push(Taken {
            percept,
            action,
            reward,
            bumped,
        });
        credit
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        if let Some(last) = self.path.last_mut() {
            last.reward += long_term_reward;
            let Taken {
                percept, bumped, ..
            } = *last;
            if reached_goal {
                self.learn_last_step(None);
            } else if bumped {
                self.learn_last_step(Some(percept));
            }
        }
        self.path.clear();
        self.notice_slips();
        self.exploration.begin();
        self.known.tidy();
        self.teach();
        EndCredit {
            long_term_reward,
            learning_rate: self.xcs.params().beta,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.xcs.worth(percept)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Foresighted {
            rules: self.xcs.population().clone(),
            foresight: Foresight {
                collisions: self.collisions.rules(),
                returns: self.known.returns().rules().collect(),
            },
        }
    }

    /// Only the foresight: what is best in one maze says nothing of the next.
    fn bring(&mut self, knowledge: &Knowledge) -> bool {
        let Knowledge::Foresighted { foresight, .. } = knowledge else {
            return false;
        };
        if self.own.collision_rules {
            self.collisions.bring(&foresight.collisions);
        }
        if self.own.return_rules {
            self.known.bring(&foresight.returns);
        }
        true
    }

    fn rule_count(&self) -> usize {
        self.xcs.population().len()
    }

    fn memory(&self) -> Vec<u8> {
        memory::of(&(
            (self.xcs.learned(), &self.stream),
            (&self.memory, self.known.kept(), &self.lessons),
            (self.collisions.kept(), self.exploration.kept()),
        ))
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let mut method = self.clone();
        let (of_rules, of_model, of_exploration) = memory::recall(saved)?;
        let (learned, known, collisions, exploration);
        (learned, method.stream) = of_rules;
        (method.memory, known, method.lessons) = of_model;
        (collisions, exploration) = of_exploration;
        let fits = method.xcs.resume(learned)
            && method.memory.is_sound()
            && method.lessons_are_sound()
            && method.known.resume(known, &method.memory)
            && method.collisions.resume(collisions);
        method.exploration.resume(exploration);
        memory::resumed(method, fits)
    }
}
