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
    (0..8)
        .map(|cell| u8::from(state(a, cell) != state(b, cell)))
        .sum()
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
            belief: core::array::from_fn(|at| Weight::from(u8::from(at == usize::from(BEGIN)))),
            next: [NONE; STATES],
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
        let mut most = NONE;
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
        let State {
            x,
            y,
            map,
            collected,
            ..
        } = STATE_TABLE[usize::from(likeliest)];
        Context {
            x,
            y,
            map,
            collected,
            ..context
        }
    }

    /// Computes the next belief after an action from the transitions that fit. Returns true if any
    /// state is left.
    fn follow(&mut self, action: u8, fits: impl Fn(usize, &State, u16) -> bool) -> bool {
        self.next = [NONE; STATES];
        for (from, state) in STATE_TABLE.iter().enumerate() {
            let mut lead = |executed: usize, weight: Weight| {
                let to = state.next[executed];
                if to != GOAL && fits(from, &STATE_TABLE[usize::from(to)], to) {
                    self.next[usize::from(to)] += weight;
                }
            };
            let chosen = usize::from(action);
            let [of_chosen, of_other] = shares(self.belief[from]);
            if of_chosen > NONE {
                lead(chosen, of_chosen);
            }
            if of_other > NONE {
                (0..ACTIONS)
                    .filter(|&other| other != chosen)
                    .for_each(|other| lead(other, of_other));
            }
        }
        settle(&mut self.next)
    }
}

impl Default for Tracker {
    fn default() -> Self {
        Self::new()
    }
}
