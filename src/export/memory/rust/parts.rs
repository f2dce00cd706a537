//! The parts of the tracker in Rust. Which parts are used depends on whether moves slip and on
//! whether percepts have errors.

/// The types that are the same for all maps.
pub const TYPES: &str = r"
/// A state: a cell of a map, and the rewards collected so far.
#[derive(Clone, Copy)]
pub struct State {
    /// The state that each action leads to, or `GOAL`.
    pub next: [u16; ACTIONS],
    /// The percept in this state.
    pub percept: u16,
    /// Cells to the east of the goal.
    pub x: i8,
    /// Cells to the north of the goal.
    pub y: i8,
    /// The number of the map. Each map is drawn around one goal.
    pub map: u8,
    /// A bit mask of the rewards of the map that were collected.
    pub collected: u8,
}

/// The input of the rules. A step is 1 + 2 * action + 16 * percept, or 0 if there was none.
#[derive(Clone, Copy, Default)]
pub struct Context {
    /// The last step.
    pub last: u32,
    /// The step before the last.
    pub before: u32,
    /// The percept; with observation errors, the percept of the likeliest state.
    pub percept: u16,
    /// Of the likeliest state: cells to the east of the goal.
    pub x: i8,
    /// Cells to the north of the goal.
    pub y: i8,
    /// The number of the map.
    pub map: u8,
    /// A bit mask of the rewards of the map that were collected.
    pub collected: u8,
}
";

/// The code that counts votes, and the head of the rules.
pub const VOTES: &str = r"
#[derive(Default)]
struct Votes {
    value: [u64; ACTIONS],
    weight: [u64; ACTIONS],
}

impl Votes {
    fn add(&mut self, action: usize, weight: u64, value: u64) {
        self.value[action] += value * weight;
        self.weight[action] += weight;
    }

    /// Returns the action with the greatest mean value, the first of equals; `None` if there are no
    /// votes.
    fn elected(&self) -> Option<u8> {
        let mut best: Option<usize> = None;
        for action in (0..ACTIONS).filter(|&action| self.weight[action] != 0) {
            let is_greater = |best: usize| {
                u128::from(self.value[action]) * u128::from(self.weight[best])
                    > u128::from(self.value[best]) * u128::from(self.weight[action])
            };
            if best.is_none_or(is_greater) {
                best = Some(action);
            }
        }
        best.map(|action| action as u8)
    }
}

/// Applies the rules. Each matching rule votes for an action with a weight and a value.
fn decide(c: &Context) -> Option<u8> {
    let mut votes = Votes::default();
";

/// Removes negligible states from integer beliefs.
pub const SETTLE_WHOLE: &str = r"
/// The weight of a state; only the ratios matter.
type Weight = u16;

/// Removes unlikely states. Returns true if any state is left.
fn settle(belief: &mut [Weight; STATES]) -> bool {
    let sum: u32 = belief.iter().map(|&weight| u32::from(weight)).sum();
    for weight in belief.iter_mut().filter(|weight| u32::from(**weight) * 10_000 <= sum) {
        *weight = 0;
    }
    belief.iter().any(|&weight| weight > 0)
}
";

/// Like [`SETTLE_WHOLE`], for floating-point beliefs, which are normalised to a sum of 1.
pub const SETTLE_DOUBLE: &str = r"
/// The probability of a state.
type Weight = f64;

/// Removes unlikely states and normalises the others to a sum of 1. Returns true if any state is
/// left.
fn settle(belief: &mut [Weight; STATES]) -> bool {
    let sum: f64 = belief.iter().sum();
    for weight in belief.iter_mut().filter(|weight| **weight <= {NEGLIGIBLE} * sum) {
        *weight = 0.0;
    }
    let kept: f64 = belief.iter().sum();
    for weight in belief.iter_mut().filter(|_| kept > 0.0) {
        *weight /= kept;
    }
    kept > 0.0
}
";

/// The part that all trackers share.
pub const TRACKER: &str = r"
/// Returns the number of rewards collected in a state.
fn found_in(state: &State) -> u8 {
    state.collected.count_ones() as u8
}

/// Returns in how many of the eight surrounding cells two percepts differ. The value 1 is not a cell
/// state. It counts as 0 (free), because most cells are free.
fn differences(a: u16, b: u16) -> u8 {
    let state = |percept: u16, cell: u16| match percept >> (2 * cell) & 3 {
        1 => 0,
        state => state,
    };
    (0..8).map(|cell| u8::from(state(a, cell) != state(b, cell))).sum()
}

/// The state of an episode.
#[derive(Clone)]
pub struct Tracker {
    /// The probability of each state, up to a factor.
    belief: [Weight; STATES],
    /// The next belief, while it is computed.
    next: [Weight; STATES],
    last: u32,
    before: u32,
    percept: u16,
    found: u8,
    /// The action that was chosen for the last percept.
    pub action: Option<u8>,
}

impl Tracker {
    /// Creates a tracker at the beginning of an episode.
    pub fn new() -> Self {
        Self {
            belief: {BEGIN},
            next: [{ZERO}; STATES],
            last: 0,
            before: 0,
            percept: 0,
            found: 0,
            action: None,
        }
    }

    /// Returns the action for a percept. `bumped` and `rewarded` describe the result of the last
    /// action.
    pub fn perceive(&mut self, percept: u16, bumped: bool, rewarded: bool) -> Option<u8> {
        if let Some(action) = self.action {
            self.before = self.last;
            self.last = 1 | u32::from(action) << 1 | u32::from(self.percept) << 4;
        }
        self.locate(percept, bumped, rewarded);
        self.action = decide(&self.context());
        self.action
    }

    /// Returns the likeliest state, the first of several; `None` if the belief is empty.
    pub fn likeliest(&self) -> Option<u16> {
        let mut best = None;
        let mut most = {ZERO};
        for (at, &weight) in self.belief.iter().enumerate() {
            if weight > most {
                (best, most) = (Some(at as u16), weight);
            }
        }
        best
    }

    /// Returns the input of the rules.
    pub fn context(&self) -> Context {
        let context = Context {
            last: self.last,
            before: self.before,
            percept: self.percept,
            ..Context::default()
        };
        let Some(likeliest) = self.likeliest() else {
            return context;
        };
        let State { x, y, map, collected, .. } = STATE_TABLE[usize::from(likeliest)];
        Context { x, y, map, collected, ..context }
    }

    /// Computes the next belief after an action from the transitions that fit. Returns true if any
    /// state is left.
    fn follow(&mut self, action: u8, fits: impl Fn(usize, &State, u16) -> bool) -> bool {
        self.next = [{ZERO}; STATES];
        for from in 0..STATES {
            let weight = self.belief[from];
            let mut lead = |executed: usize, weight: Weight| {
                let to = STATE_TABLE[from].next[executed];
                if to != GOAL && fits(from, &STATE_TABLE[usize::from(to)], to) {
                    self.next[usize::from(to)] += weight;
                }
            };
            if weight > {ZERO} {
{MOVES}
            }
        }
        settle(&mut self.next)
    }
";

/// The chosen action is executed.
pub const EXACT_MOVES: &str = "                lead(usize::from(action), weight);";

/// The chosen action is executed, or another one, each with the same probability.
pub const SLIPPING_MOVES: &str = "                lead(usize::from(action), weight * (1.0 - SLIP));
                for executed in (0..ACTIONS).filter(|&other| other != usize::from(action)) {
                    lead(executed, weight * (SLIP / (ACTIONS - 1) as f64));
                }";

/// Localisation with exact percepts.
pub const LOCATE_EXACT: &str = r"
    /// Updates the belief. A collision shows in the percept.
    fn locate(&mut self, percept: u16, _bumped: bool, rewarded: bool) {
        self.percept = percept;
        let looks = |state: &State, found: u8| state.percept == percept && found_in(state) == found;
        let Some(action) = self.action else {
            let mut believed = (0..STATES).filter(|&at| self.belief[at] > {ZERO}).peekable();
            let any = believed.peek().is_some();
            if !any || !believed.all(|at| looks(&STATE_TABLE[at], self.found)) {
                self.look_around(percept);
            }
            return;
        };
        // A reward that was not predicted, or did not come, still gives evidence about the state.
        for found in [self.found + u8::from(rewarded), self.found + u8::from(!rewarded)] {
            if self.follow(action, |_, state, _| looks(state, found)) {
                self.belief = self.next;
                self.found = found;
                return;
            }
        }
        self.found = (self.found + u8::from(rewarded)).min(REWARDS);
        self.look_around(percept);
    }

    /// Spreads the belief over all states whose percept differs least.
    fn look_around(&mut self, percept: u16) {
        let found = self.found;
        let strange = |state: &State| match found_in(state) == found {
            true => differences(state.percept, percept),
            false => u8::MAX,
        };
        let least = STATE_TABLE.iter().map(strange).min().unwrap_or(u8::MAX);
        for (state, weight) in STATE_TABLE.iter().zip(&mut self.belief) {
            *weight = Weight::from(u8::from(least < u8::MAX && strange(state) == least));
        }
        settle(&mut self.belief);
    }
}
";

/// Localisation with observation errors.
pub const LOCATE_NOISY: &str = r"
    /// Updates the belief. Each state is weighted by its prediction and by the number of
    /// observation errors that it implies. With a small probability the robot is in any state.
    fn locate(&mut self, percept: u16, {BUMPED}: bool, rewarded: bool) {
        let (expects, mislocalised) = match self.action {
            Some(action) => {
                self.found = (self.found + u8::from(rewarded)).min(REWARDS);
                let expects = self.follow(action, {MAY_LEAD});
                (expects, {MISLOCALISED})
            }
            None => {
                self.next = self.belief;
                (self.likeliest().is_some(), {BEGUN_ELSEWHERE})
            }
        };
        let mislocalised = if expects { mislocalised } else { 1.0 };
        for (at, state) in STATE_TABLE.iter().enumerate() {
            let wrong = differences(state.percept, percept) + u8::from(found_in(state) != self.found);
            let likely = (0..wrong).fold(1.0, |likely, _| likely * OBSERVATION_ERROR);
            let weight = self.next[at] * (1.0 - mislocalised) + mislocalised / STATES as f64;
            self.belief[at] = weight * likely;
        }
        settle(&mut self.belief);
        let likeliest = self.likeliest();
        self.percept = likeliest.map_or(percept, |at| STATE_TABLE[usize::from(at)].percept);
    }
}
";
