//! The places that a filter knows, as a table.

use serde::Serialize;

use crate::agent::places::{Came, NEAR, NEGLIGIBLE, OPEN, Places};
use crate::export::ballot::{ExportError, MOST_STATES};
use xcs::{Action, Percept};

/// What a filter knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Filter {
    /// What looks like a place but for so many bits comes to mind where it was not expected.
    pub near: u32,
    /// Places are forgotten that are less likely than the likeliest by this factor.
    pub negligible: f64,
    /// The weight of all that never came of an action, in tries.
    pub open: f64,
    /// Of it the weight of a collision.
    pub open_bump: f64,
    /// How likely a percept is to be seen in a place, by the number of bits in which it differs, beside
    /// what looks like the place itself.
    pub looks: Vec<f64>,
    places: Vec<Place>,
    /// Any place that was never met.
    never_met: Place,
}

/// A place: all cells that look alike.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// What it looks like, if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub percept: Option<Percept>,
    /// Did an episode ever begin there?
    pub begun: bool,
    /// How likely one does.
    pub begin: f64,
    /// The weight of that an action leads there although it never did, in tries.
    pub open: f64,
    /// By action: how often it was tried there.
    pub tries: Vec<u32>,
    /// What came of it.
    pub came: Vec<Line>,
}

/// What came of an action, and how often.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// The action.
    pub action: usize,
    /// The place to which it led; `None` if the robot bumped.
    pub to: Option<u16>,
    /// How often.
    pub count: u32,
}

impl Filter {
    /// The filter that knows these places, which percepts of `width` bits tell, and so many actions; `None`
    /// if it knows none.
    ///
    /// # Errors
    /// When they are too many.
    pub fn new(known: &Places, width: usize, actions: usize) -> Result<Option<Self>, ExportError> {
        let mut known = known.clone();
        // Where the robot never was, as is believed in the end, is no place. After an episode there is none.
        known.forget(0);
        match known.len() {
            0 => return Ok(None),
            1..MOST_STATES => {}
            many => return Err(ExportError::Places(many)),
        }
        let place = |at| Place::new(&known, at, actions);
        Ok(Some(Self {
            near: NEAR,
            negligible: NEGLIGIBLE,
            open: OPEN,
            open_bump: known.open(Some(Came::Bumped)),
            looks: (0..=width as u32)
                .map(|bits| known.misreading(bits))
                .collect(),
            places: (0..known.len()).map(place).collect(),
            never_met: Place {
                percept: None,
                begun: false,
                begin: known.chance_to_begin(None),
                open: known.open(None),
                tries: vec![0; actions],
                came: Vec::new(),
            },
        }))
    }

    /// Source code with its figures in place of their names.
    pub fn figures_in(&self, code: &str) -> String {
        code.replace("{NEAR}", &self.near.to_string())
            .replace("{NEGLIGIBLE}", &format!("{:?}", self.negligible))
            .replace("{OPEN_BUMP}", &format!("{:?}", self.open_bump))
            .replace("{OPEN}", &format!("{:?}", self.open))
    }

    /// How many places were met.
    pub fn met(&self) -> usize {
        self.places.len()
    }

    /// What the places look like that were met.
    pub fn percepts(&self) -> impl Iterator<Item = Percept> {
        self.places.iter().filter_map(|place| place.percept)
    }

    /// All places; the last one stands for any that was never met.
    pub fn places(&self) -> impl Iterator<Item = &Place> {
        self.places.iter().chain([&self.never_met])
    }

    /// What came of actions, place by place.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.places().flat_map(|place| &place.came)
    }
}

impl Place {
    fn new(known: &Places, at: usize, actions: usize) -> Self {
        let tries = |action| known.tally(at, action, Came::Bumped)[1];
        Self {
            percept: Some(*known.percept(at)),
            begun: known.begun(at)[0] > 0,
            begin: known.chance_to_begin(Some(at)),
            open: known.open(Some(Came::To(at))),
            tries: Action::all(actions).map(tries).collect(),
            came: Action::all(actions)
                .flat_map(|action| lines(known, at, action))
                .collect(),
        }
    }

    /// What it looks like in so many bytes, 0 if that is not known; bit `i` is bit `i % 8` of byte `i / 8`.
    pub fn bytes(&self, count: usize) -> Vec<u8> {
        let words = self.percept.iter().flat_map(Percept::words);
        let mut bytes: Vec<u8> = words.flat_map(|word| word.to_le_bytes()).collect();
        bytes.resize(count, 0);
        bytes
    }
}

impl Line {
    /// The place, or the name of none.
    pub fn to(&self, bumped: &str) -> String {
        self.to.map_or(bumped.to_owned(), |to| to.to_string())
    }
}

/// What came of an action in a place, but for ends of episodes.
fn lines(known: &Places, at: usize, action: Action) -> Vec<Line> {
    let mut next: Vec<usize> = known.successors(at, action).collect();
    next.sort_unstable();
    next.dedup();
    let led = next.into_iter().map(|to| (Some(to as u16), Came::To(to)));
    let line = |(to, came)| Line {
        action: action.index(),
        to,
        count: known.tally(at, action, came)[0],
    };
    let all = led.chain([(None, Came::Bumped)]).map(line);
    all.filter(|line| line.count > 0).collect()
}
