//! The filter in Rust.

use super::Addition;
use super::places::{Filter, Line, Place};
use super::usage::{Calls, costs, usage};
use crate::export::Ballot;
use crate::export::comments::RUST as COMMENTS;

/// How to use it.
const CALLS: Calls = Calls {
    begin: "make a Filter::new()",
    step: "let action = filter.perceive(&percept, bumped);",
    none: "None",
};

/// The types.
const TYPES: &str = r"
/// A place: all cells that look alike.
pub struct Place {
    /// How likely an episode begins there.
    begin: f64,
    /// The weight of that an action leads there although it never did, in tries.
    open: f64,
    /// How often each action was tried there.
    tries: [u32; ACTIONS],
    /// The first line on what came of them.
    first: u32,
    /// And how many there are.
    lines: u16,
    /// Did an episode ever begin there?
    begun: bool,
    /// What it looks like.
    pub percept: [u8; PERCEPT_BYTES],
}

/// What came of an action, and how often.
pub struct Line {
    count: u32,
    /// The place to which it led, or `BUMPED`.
    to: u16,
    action: u8,
}
";

/// The functions.
const FILTER: &str = r"
/// In how many bits a percept differs from that of a place.
fn differences(percept: &[u8; PERCEPT_BYTES], at: usize) -> u32 {
    let bytes = percept.iter().zip(&KNOWN[at].percept);
    bytes.map(|(seen, there)| (seen ^ there).count_ones()).sum()
}

/// How likely this is to be seen in a place, beside what looks like it.
fn look(percept: &[u8; PERCEPT_BYTES], at: usize) -> f64 {
    match at {
        PLACES => 1.0,
        _ => LOOKS[differences(percept, at) as usize],
    }
}

/// Does a place come to mind when this is seen? One that was never met does if none looks just so.
fn comes_to_mind(percept: &[u8; PERCEPT_BYTES], at: usize) -> bool {
    match at {
        PLACES => (0..PLACES).all(|at| differences(percept, at) > 0),
        _ => differences(percept, at) <= {NEAR},
    }
}

/// What came of actions in a place.
fn lines(at: usize) -> &'static [Line] {
    let first = KNOWN[at].first as usize;
    &LINES[first..first + usize::from(KNOWN[at].lines)]
}

/// How often this came of an action.
fn count(from: usize, action: u8, to: u16) -> u32 {
    let mut lines = lines(from).iter();
    let line = lines.find(|line| line.action == action && line.to == to);
    line.map_or(0, |line| line.count)
}

/// How likely this is to come of an action.
fn chance(from: usize, action: u8, to: u16) -> f64 {
    let open = match to {
        BUMPED => {OPEN_BUMP},
        _ => KNOWN[usize::from(to)].open,
    };
    let tries = KNOWN[from].tries[usize::from(action)];
    (f64::from(count(from, action, to)) + open) / (f64::from(tries) + {OPEN})
}

/// What is remembered of an episode.
#[derive(Clone)]
pub struct Filter {
    /// How likely each place is, beside the likeliest.
    belief: [f64; PLACES + 1],
    /// The same while it is being computed.
    next: [f64; PLACES + 1],
    /// What is done.
    pub action: Option<u8>,
}

impl Filter {
    /// At the beginning of an episode.
    pub fn new() -> Self {
        Self {
            belief: [0.0; PLACES + 1],
            next: [0.0; PLACES + 1],
            action: None,
        }
    }

    /// The action for what is perceived now, after the action before it.
    pub fn perceive(&mut self, percept: &[u8; PERCEPT_BYTES], bumped: bool) -> Option<u8> {
        match self.action {
            None => self.begin(percept),
            Some(action) if bumped => self.stay(action, percept),
            Some(action) => self.leave(action, percept),
        }
        self.settle();
        self.action = match self.likeliest() {
            PLACES => decide(percept),
            place => decide(&KNOWN[place].percept),
        };
        self.action
    }

    /// The likeliest place, the first of several; `PLACES` if that was never met.
    pub fn likeliest(&self) -> usize {
        let (mut likeliest, mut most) = (PLACES, 0.0);
        for (at, &weight) in self.belief.iter().enumerate() {
            if weight > most {
                (likeliest, most) = (at, weight);
            }
        }
        likeliest
    }

    /// Weighs where an episode may begin.
    fn begin(&mut self, percept: &[u8; PERCEPT_BYTES]) {
        for (at, next) in self.next.iter_mut().enumerate() {
            let fits = KNOWN[at].begun || comes_to_mind(percept, at);
            *next = if fits { KNOWN[at].begin * look(percept, at) } else { 0.0 };
        }
    }

    /// The same after a collision: the robot is where it was.
    fn stay(&mut self, action: u8, percept: &[u8; PERCEPT_BYTES]) {
        self.next = self.belief;
        for (at, next) in self.next.iter_mut().enumerate().filter(|(_, next)| **next > 0.0) {
            *next = *next * chance(at, action, BUMPED) * look(percept, at);
        }
    }

    /// Weighs where the robot may be after a move.
    fn leave(&mut self, action: u8, percept: &[u8; PERCEPT_BYTES]) {
        if let Some(foreseen) = self.foreseen(action, percept) {
            self.next = [0.0; PLACES + 1];
            self.next[foreseen] = 1.0;
            return;
        }
        self.mark(action, percept);
        for (from, &before) in self.belief.iter().enumerate().filter(|(_, before)| **before > 0.0) {
            for (to, next) in self.next.iter_mut().enumerate().filter(|(_, next)| **next >= 0.0) {
                *next += before * chance(from, action, to as u16);
            }
        }
        for (to, next) in self.next.iter_mut().enumerate() {
            *next = if *next >= 0.0 { *next * look(percept, to) } else { 0.0 };
        }
    }

    /// Where an action led in more than half of its tries from the only place that is believed, if
    /// that looks just like this.
    fn foreseen(&self, action: u8, percept: &[u8; PERCEPT_BYTES]) -> Option<usize> {
        let mut believed = (0..=PLACES).filter(|&at| self.belief[at] > 0.0);
        let from = believed.next().filter(|&from| from != PLACES)?;
        let tries = KNOWN[from].tries[usize::from(action)];
        let is_usual = |&to: &usize| 2 * count(from, action, to as u16) > tries;
        let looks = |&to: &usize| differences(percept, to) == 0;
        match believed.next() {
            None => (0..PLACES).filter(looks).find(is_usual),
            Some(_) => None,
        }
    }

    /// Marks with 0 the places where the robot may be, and all others with -1.
    fn mark(&mut self, action: u8, percept: &[u8; PERCEPT_BYTES]) {
        for (at, next) in self.next.iter_mut().enumerate() {
            *next = if comes_to_mind(percept, at) { 0.0 } else { -1.0 };
        }
        for from in (0..PLACES).filter(|&from| self.belief[from] > 0.0) {
            let led = lines(from).iter().filter(|line| line.action == action && line.to != BUMPED);
            for line in led {
                self.next[usize::from(line.to)] = 0.0;
            }
        }
    }

    /// Believes what was weighed, beside the likeliest place, and forgets what is negligible.
    fn settle(&mut self) {
        let greatest = self.next.iter().fold(0.0, |most, &weight| if weight > most { weight } else { most });
        for (belief, &weight) in self.belief.iter_mut().zip(&self.next) {
            let counts = weight > 0.0 && weight >= {NEGLIGIBLE} * greatest;
            *belief = if counts { weight / greatest } else { 0.0 };
        }
    }
}
";

/// What it adds to a module.
pub fn addition(ballot: &Ballot, filter: &Filter) -> Addition {
    let usage = [usage(&CALLS), costs(ballot, filter)].concat();
    Addition {
        usage: COMMENTS.of(&usage),
        code: [
            TYPES,
            &tables(filter, ballot.bytes()),
            &filter.figures_in(FILTER),
        ]
        .concat(),
    }
}

/// All that is known.
fn tables(filter: &Filter, bytes: usize) -> String {
    let mut first = 0;
    let mut places = String::new();
    for place in filter.places() {
        places.push_str(&row(place, first, bytes));
        first += place.came.len();
    }
    let lines: String = filter.lines().map(line).collect();
    let looks: String = filter
        .looks
        .iter()
        .map(|look| format!("    {look:?},\n"))
        .collect();
    format!(
        "\n/// How many places are known; as a number any that was never met.\n\
         pub const PLACES: usize = {};\n\
         /// In place of a place: the robot stayed where it was.\n\
         const BUMPED: u16 = u16::MAX;\n\
         \n/// All places, and one for any that was never met.\n\
         pub static KNOWN: [Place; PLACES + 1] = [\n{places}];\n\
         \n/// What came of actions, place by place.\n\
         pub static LINES: [Line; {first}] = [\n{lines}];\n\
         \n/// How likely so many bits are misread, beside that none is.\n\
         pub static LOOKS: [f64; {}] = [\n{looks}];\n",
        filter.met(),
        filter.looks.len()
    )
}

fn row(place: &Place, first: usize, bytes: usize) -> String {
    let Place {
        begun,
        begin,
        open,
        tries,
        came,
        ..
    } = place;
    format!(
        "    Place {{ begin: {begin:?}, open: {open:?}, tries: {tries:?}, first: {first}, lines: {}, \
         begun: {begun}, percept: {:?} }},\n",
        came.len(),
        place.bytes(bytes)
    )
}

fn line(line: &Line) -> String {
    let Line { action, count, .. } = line;
    let to = line.to("BUMPED");
    format!("    Line {{ count: {count}, to: {to}, action: {action} }},\n")
}
