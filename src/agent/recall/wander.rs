//! Finding the goal, and what is not yet known: the robot's own sketch of an episode.

use std::collections::{BTreeMap, VecDeque};

use super::align::{Habits, Seen, likeliest_move};
use super::chart::Chart;
use super::headings::Headings;
use super::place::{Around, Letter, Place, offset};
use xcs::Action;
use xcs::random::Stream;

/// Where the robot has been in this episode, counted from where it began.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sketch {
    chart: Chart,
    visits: BTreeMap<Place, u32>,
    here: Place,
    /// What is perceived here.
    around: Option<Around>,
}

impl Sketch {
    /// The robot perceives this after a step, or at the beginning.
    pub fn perceive(&mut self, last: Option<&Seen>, around: &Around, habits: &Habits) {
        if let Some(last) = last {
            self.here = self.here.plus(likeliest_move(last, around, habits));
        }
        self.around = Some(*around);
        self.chart.take_down(self.here, around);
        *self.visits.entry(self.here).or_default() += 1;
    }

    /// An action of which nobody can tell what comes of it here; if there is none, the one that leads
    /// toward the nearest goal or free cell in which the robot has not been; any action if there is
    /// none either. Chance decides between several.
    pub fn explore(&self, headings: &Headings, feels_bumps: bool, stream: &mut Stream) -> Action {
        let mut likely: Vec<Action> = Action::all(headings.actions()).collect();
        let is_open = |action: &Action| {
            self.around
                .is_some_and(|around| headings.leave_open(*action, &around, feels_bumps))
        };
        let open = likely.iter().copied().filter(is_open).collect::<Vec<_>>();
        let news = if open.is_empty() {
            self.nearest_news(headings)
        } else {
            open
        };
        if !news.is_empty() {
            likely = news;
        }
        *stream.choose(&likely).expect("there is an action")
    }

    /// The first actions of the shortest ways to what is nearest.
    fn nearest_news(&self, headings: &Headings) -> Vec<Action> {
        let certain = |action| Some((action, offset(headings.certain(action)?)));
        let moves: Vec<_> = Action::all(headings.actions())
            .filter_map(certain)
            .collect();
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
            for &(action, by) in &moves {
                let to = place.plus(by);
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
        moves.iter().map(|one| one.0).filter(is_first).collect()
    }

    fn is_news(&self, place: Place) -> bool {
        !self.visits.contains_key(&place)
    }
}
