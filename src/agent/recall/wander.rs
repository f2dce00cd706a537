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
    /// none either. Chance decides between several. If `passes_goals`, no goal counts while anything else can be
    /// reached.
    pub fn explore(
        &self,
        headings: &Headings,
        feels_bumps: bool,
        passes_goals: bool,
        stream: &mut Stream,
    ) -> Action {
        let mut likely: Vec<Action> = Action::all(headings.actions()).collect();
        let is_open = |action: &Action| {
            self.around
                .is_some_and(|around| headings.leave_open(*action, &around, feels_bumps))
        };
        let open = likely.iter().copied().filter(is_open).collect::<Vec<_>>();
        let is_new = |place| !self.visits.contains_key(&place);
        let is_open = |place| is_new(place) && self.chart.letter(place) != Some(Letter::Goal);
        let mut news = open;
        if news.is_empty() && passes_goals {
            news = self.nearest(headings, is_open);
        }
        if news.is_empty() {
            news = self.nearest(headings, is_new);
        }
        if !news.is_empty() {
            likely = news;
        }
        *stream.choose(&likely).expect("there is an action")
    }

    /// The first actions of the shortest ways to the nearest places that are sought.
    fn nearest(&self, headings: &Headings, is_sought: impl Fn(Place) -> bool) -> Vec<Action> {
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
            if is_sought(place) {
                (found, firsts) = (steps, firsts | first);
                continue;
            }
            for &(action, by) in &moves {
                let to = place.plus(by);
                let leads_on = match self.chart.letter(to) {
                    Some(Letter::Free) => true,
                    // There the episode ends.
                    Some(Letter::Goal) => is_sought(to),
                    _ => false,
                };
                if !leads_on {
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
}

#[cfg(test)]
mod tests {
    use super::super::bumped::Bumped;
    use super::*;
    use crate::agent::recall::place::Vision;

    const EAST: usize = 2;
    const WEST: usize = 6;

    /// Where a robot heads in a corridor, of so many cells and with a goal at its western end, that has gone from
    /// beside the goal to the third cell and back.
    fn heads(cells: i32, passes_goals: bool) -> usize {
        let headings = Headings::known(8);
        let habits = Habits {
            headings,
            vision: Vision::LookedUp,
            slip: 1e-4,
            misread: 1e-4,
        };
        let mut sketch = Sketch::default();
        let mut last: Option<Seen> = None;
        for (at, action) in [(0, EAST), (1, EAST), (2, WEST), (1, WEST), (0, WEST)] {
            let mut around = [Letter::Wall; 8];
            around[WEST] = [Letter::Goal, Letter::Free][usize::from(at > 0)];
            around[EAST] = [Letter::Free, Letter::Wall][usize::from(at == cells - 1)];
            sketch.perceive(last.as_ref(), &around, &habits);
            last = Some(Seen {
                around,
                action: Action::new(action).unwrap(),
                found: 0.0,
                bumped: Bumped::No,
            });
        }
        let mut stream = Stream::new(1, 0_u64);
        let action = sketch.explore(&headings, true, passes_goals, &mut stream);
        action.index()
    }

    #[test]
    fn a_goal_is_walked_past_while_anything_else_is_new() {
        assert_eq!(heads(4, true), EAST);
        assert_eq!(heads(3, true), WEST, "nothing else is new");
        assert_eq!(heads(4, false), WEST, "control");
    }
}
