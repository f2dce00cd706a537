//! The tracker in Rust, in parts: which are taken depends on whether moves slip and percepts are misread.

/// The types that do not depend on anything.
pub const TYPES: &str = r"
/// A state: a place on a map, and what was found before.
#[derive(Clone, Copy)]
pub struct State {
    /// The state that each action leads to, or `GOAL`.
    pub next: [u16; ACTIONS],
    /// What is perceived there.
    pub percept: u16,
    /// Cells to the east of the goal.
    pub x: i8,
    /// Cells to the north of it.
    pub y: i8,
    /// The number of the map: each is drawn around one goal.
    pub map: u8,
    /// As bits: which rewards of the map were found.
    pub collected: u8,
}

/// What rules look at. A step is 1 + 2 * action + 16 * percept, or 0 if there was none.
#[derive(Clone, Copy, Default)]
pub struct Context {
    /// The last step.
    pub last: u32,
    /// The step before it.
    pub before: u32,
    /// What is perceived; where cells are misread, what should be.
    pub percept: u16,
    /// Of the likeliest state: cells to the east of the goal.
    pub x: i8,
    /// Cells to the north of it.
    pub y: i8,
    /// The number of the map.
    pub map: u8,
    /// As bits: which rewards of the map were found.
    pub collected: u8,
}
";

/// Counting votes, and the head of the rules.
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

    /// The action of the greatest mean value, the first of equals; `None` if nobody voted.
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

/// The rules: each that matches votes for an action with a weight and a value.
fn decide(c: &Context) -> Option<u8> {
    let mut votes = Votes::default();
";

/// Forgets what is negligible, in whole numbers.
pub const SETTLE_WHOLE: &str = r"
/// How likely a state is; only the ratios count.
type Weight = u16;

/// Forgets states that are unlikely; is any left?
fn settle(belief: &mut [Weight; STATES]) -> bool {
    let sum: u32 = belief.iter().map(|&weight| u32::from(weight)).sum();
    for weight in belief.iter_mut().filter(|weight| u32::from(**weight) * 10_000 <= sum) {
        *weight = 0;
    }
    belief.iter().any(|&weight| weight > 0)
}
";

/// The same in fractions, which then add up to 1.
pub const SETTLE_DOUBLE: &str = r"
/// The probability of a state.
type Weight = f64;

/// Forgets states that are unlikely, and makes the others add up to 1; is any left?
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

/// What all trackers share.
pub const TRACKER: &str = r"
/// How many rewards were found.
fn found_in(state: &State) -> u8 {
    state.collected.count_ones() as u8
}

/// In how many of the eight cells around the robot two percepts differ. A goal that is not barred, 1,
/// is no letter: most cells are free, 0.
fn differences(a: u16, b: u16) -> u8 {
    let letter = |percept: u16, cell: u16| match percept >> (2 * cell) & 3 {
        1 => 0,
        letter => letter,
    };
    (0..8).map(|cell| u8::from(letter(a, cell) != letter(b, cell))).sum()
}

/// What is remembered of an episode.
#[derive(Clone)]
pub struct Tracker {
    /// How likely each state is.
    belief: [Weight; STATES],
    /// The same while it is being computed.
    next: [Weight; STATES],
    last: u32,
    before: u32,
    percept: u16,
    found: u8,
    /// What is done on what is perceived.
    pub action: Option<u8>,
}

impl Tracker {
    /// At the beginning of an episode.
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

    /// The action for what is perceived now, and what came of the action before it.
    pub fn perceive(&mut self, percept: u16, bumped: bool, rewarded: bool) -> Option<u8> {
        if let Some(action) = self.action {
            self.before = self.last;
            self.last = 1 | u32::from(action) << 1 | u32::from(self.percept) << 4;
        }
        self.locate(percept, bumped, rewarded);
        self.action = decide(&self.context());
        self.action
    }

    /// The likeliest state, the first of several; `None` if nothing is believed.
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

    /// What rules look at.
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
        let State { x, y, map, collected, .. } = CHARTS[usize::from(likeliest)];
        Context { x, y, map, collected, ..context }
    }

    /// Where an action may lead, if from and to fit; can anything come of it?
    fn follow(&mut self, action: u8, fits: impl Fn(usize, &State, u16) -> bool) -> bool {
        self.next = [{ZERO}; STATES];
        for from in 0..STATES {
            let weight = self.belief[from];
            let mut lead = |executed: usize, weight: Weight| {
                let to = CHARTS[from].next[executed];
                if to != GOAL && fits(from, &CHARTS[usize::from(to)], to) {
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

/// The action that was chosen is executed.
pub const EXACT_MOVES: &str = "                lead(usize::from(action), weight);";

/// It is, or another one, each with the same chance.
pub const SLIPPING_MOVES: &str = "                lead(usize::from(action), weight * (1.0 - SLIP));
                for executed in (0..ACTIONS).filter(|&other| other != usize::from(action)) {
                    lead(executed, weight * (SLIP / (ACTIONS - 1) as f64));
                }";

/// What is believed when percepts are right.
pub const LOCATE_RIGHTLY: &str = r"
    /// Where the robot may be. That it bumped shows in what it perceives.
    fn locate(&mut self, percept: u16, _bumped: bool, rewarded: bool) {
        self.percept = percept;
        let looks = |state: &State, found: u8| state.percept == percept && found_in(state) == found;
        let Some(action) = self.action else {
            let mut believed = (0..STATES).filter(|&at| self.belief[at] > {ZERO}).peekable();
            let any = believed.peek().is_some();
            if !any || !believed.all(|at| looks(&CHARTS[at], self.found)) {
                self.look_around(percept);
            }
            return;
        };
        // A reward that was not predicted, or did not come, still tells where the robot is.
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

    /// Believes in all states that look most like this.
    fn look_around(&mut self, percept: u16) {
        let found = self.found;
        let strange = |state: &State| match found_in(state) == found {
            true => differences(state.percept, percept),
            false => u8::MAX,
        };
        let least = CHARTS.iter().map(strange).min().unwrap_or(u8::MAX);
        for (state, weight) in CHARTS.iter().zip(&mut self.belief) {
            *weight = Weight::from(u8::from(least < u8::MAX && strange(state) == least));
        }
        settle(&mut self.belief);
    }
}
";

/// What is believed when percepts may be misread.
pub const LOCATE_DOUBTINGLY: &str = r"
    /// Where the robot may be: all states weighed by what was expected, and by how much of what is
    /// perceived would be misread there. With a small probability it is anywhere.
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
        for (at, state) in CHARTS.iter().enumerate() {
            let wrong = differences(state.percept, percept) + u8::from(found_in(state) != self.found);
            let likely = (0..wrong).fold(1.0, |likely, _| likely * OBSERVATION_ERROR);
            let weight = self.next[at] * (1.0 - mislocalised) + mislocalised / STATES as f64;
            self.belief[at] = weight * likely;
        }
        settle(&mut self.belief);
        let likeliest = self.likeliest();
        self.percept = likeliest.map_or(percept, |at| CHARTS[usize::from(at)].percept);
    }
}
";
