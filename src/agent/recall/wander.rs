//! Finding the goal, and what is not yet known: the robot's own sketch of an episode.

use std::collections::{BTreeMap, VecDeque};

use super::align::{Habits, Seen, likeliest_move};
use super::chart::Chart;
use super::place::{AROUND, Around, Letter, Place, heading};
use xcs::Action;
use xcs::random::Stream;

/// Where the robot has been in this episode, counted from where it began.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sketch {
    chart: Chart,
    visits: BTreeMap<Place, u32>,
    here: Place,
}

impl Sketch {
    /// The robot perceives this after a step, or at the beginning.
    pub fn perceive(&mut self, last: Option<&Seen>, around: &Around, habits: &Habits) {
        if let Some(last) = last {
            self.here = self.here.plus(likeliest_move(last, around, habits));
        }
        self.chart.take_down(self.here, around);
        *self.visits.entry(self.here).or_default() += 1;
    }

    /// The action that leads toward the nearest goal or free cell in which the robot has not been,
    /// chance deciding between several; any action if there is none.
    pub fn explore(&self, actions: usize, stream: &mut Stream) -> Action {
        let firsts = self.nearest_news(actions);
        let all: Vec<Action> = Action::all(actions).collect();
        let chosen = stream.choose(if firsts.is_empty() { &all } else { &firsts });
        *chosen.expect("there is an action")
    }

    /// The first actions of the shortest ways to what is nearest.
    fn nearest_news(&self, actions: usize) -> Vec<Action> {
        // By place: steps from here, and the first actions of the ways there as bits.
        let mut ways: BTreeMap<Place, (u32, u32)> = BTreeMap::from([(self.here, (0, 0))]);
        let mut queue = VecDeque::from([self.here]);
        let (mut found, mut firsts) = (u32::MAX, 0);
        while let Some(place) = queue.pop_front() {
            let (steps, first) = ways[&place];
            if steps > found {
                break;
            }
            if self.is_news(place) {
                (found, firsts) = (steps, firsts | first);
                continue;
            }
            for action in Action::all(actions) {
                let to = place.plus(AROUND[heading(action, actions)]);
                if !matches!(self.chart.letter(to), Some(Letter::Free | Letter::Goal)) {
                    continue;
                }
                let first = if steps == 0 {
                    1 << action.index()
                } else {
                    first
                };
                match ways.get_mut(&to) {
                    Some(way) if way.0 == steps + 1 => way.1 |= first,
                    Some(_) => {}
                    None => {
                        ways.insert(to, (steps + 1, first));
                        queue.push_back(to);
                    }
                }
            }
        }
        let is_first = |action: &Action| firsts >> action.index() & 1 == 1;
        Action::all(actions).filter(is_first).collect()
    }

    fn is_news(&self, place: Place) -> bool {
        !self.visits.contains_key(&place)
    }
}
