//! Tests with the widest percepts and the largest number of actions.

use crate::{
    Action, Agent, Condition, Environment, MAX_ACTIONS, MAX_PERCEPT_BITS, Params, Percept,
    Population, Response, Runner,
};

/// The bits that determine the right action: the first and the last.
const TELLING: [usize; 2] = [0, MAX_PERCEPT_BITS - 1];
const SITUATIONS: usize = 1 << TELLING.len();

/// One action is right in each situation. The first and the last action are among them.
struct Lock {
    turn: usize,
    /// True if the percept shows the situation.
    tells: bool,
}

/// Returns a percept whose telling bits are those of a number. Every third of the other bits is 1.
fn percept(telling: usize) -> Percept {
    let bits = (0..MAX_PERCEPT_BITS).map(|bit| {
        let place = TELLING.iter().position(|&at| at == bit);
        place.map_or(bit % 3 == 0, |place| telling >> place & 1 == 1)
    });
    Percept::from_bits(bits).unwrap()
}

fn right(situation: usize) -> Action {
    Action::new(situation * (MAX_ACTIONS - 1) / (SITUATIONS - 1)).unwrap()
}

impl Environment for Lock {
    fn actions(&self) -> usize {
        MAX_ACTIONS
    }

    fn begin(&mut self) -> Percept {
        self.turn = (self.turn + 1) % SITUATIONS;
        percept(if self.tells { self.turn } else { 0 })
    }

    fn act(&mut self, action: Action) -> Response {
        let is_right = action == right(self.turn);
        Response {
            reward: if is_right { 1000.0 } else { 0.0 },
            next: None,
        }
    }
}

/// Returns the number of situations in which the right action is taken after learning, and the
/// rules.
fn opened(tells: bool) -> (usize, Population) {
    let params = Params {
        population_size: 3072,
        ..Params::default()
    };
    let mut runner = Runner::new(Lock { turn: 0, tells }, params, 1).unwrap();
    (0..4096).for_each(|_| {
        runner.learn();
    });
    let right = (0..SITUATIONS).filter(|_| runner.test().reward > 0.0);
    (right.count(), runner.xcs().population().clone())
}

#[test]
fn the_limits_match_the_documentation() {
    assert_eq!((MAX_PERCEPT_BITS, MAX_ACTIONS), (320, 8));
}

#[test]
fn the_widest_percepts_and_all_actions_are_learned_and_saved() {
    let (right, learned) = opened(true);
    assert_eq!(right, SITUATIONS);
    let text = serde_json::to_string(&learned).unwrap();
    assert_eq!(serde_json::from_str::<Population>(&text).unwrap(), learned);
    let bytes = postcard::to_allocvec(&learned).unwrap();
    assert_eq!(postcard::from_bytes::<Population>(&bytes).unwrap(), learned);
}

#[test]
fn control_without_the_telling_bits_it_is_not_learned() {
    let (right, _) = opened(false);
    assert!(right <= 1, "{right}");
}

#[test]
fn one_action_more_is_refused_and_the_message_names_the_bound() {
    let agent = Agent::<Condition>::new(Params::default(), (), MAX_ACTIONS + 1, 1);
    let error = agent.err().unwrap();
    let [given, last] = [MAX_ACTIONS + 1, MAX_ACTIONS];
    assert_eq!(
        error.to_string(),
        format!("`actions` is {given}, but must be from 1 to {last}")
    );
}
