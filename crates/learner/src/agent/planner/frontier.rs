//! Finding the goal, and what is not yet known: the robot's own sketch of where it has been.

use std::collections::{BTreeSet, VecDeque};

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::association::{MapStep, RobotModel, likeliest_move};
use crate::agent::estimator::map::cell_counts::{CellCounts, FURTHEST};
use crate::agent::estimator::map::motion_model::MotionModel;
use crate::agent::estimator::map::place::{CellState, Place, Surroundings, offset};
use xcs::Action;
use xcs::random::Stream;

/// Where the robot has been, counted from where episodes begin. As long as what is perceived agrees, all are
/// taken to begin in one place, and share a sketch; once it does not, each is sketched by itself.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LocalMap {
    cell_map: CellCounts,
    visited: BTreeSet<Place>,
    /// Does it hold episodes before this one, too?
    shared: bool,
    /// Was anything perceived that did not agree?
    doubted: bool,
    #[serde(skip)]
    here: Place,
    /// What is perceived here.
    #[serde(skip)]
    around: Option<Surroundings>,
}

impl LocalMap {
    /// The robot perceives this after a step, or at the beginning.
    pub fn perceive(&mut self, last: Option<&MapStep>, around: &Surroundings, robot: &RobotModel) {
        if let Some(last) = last {
            self.here = self.here.plus(likeliest_move(last, around, robot));
        }
        if !self.doubted && self.contradicts(around) {
            self.doubt();
        }
        self.around = Some(*around);
        self.cell_map.add(self.here, around);
        if self.here.reach() <= FURTHEST {
            self.visited.insert(self.here);
        }
    }

    /// Was any of this seen otherwise before?
    fn contradicts(&self, around: &Surroundings) -> bool {
        let mut cells = self.cell_map.compare(self.here, around);
        self.cell_map.cell_state(self.here) == Some(CellState::Wall)
            || cells.any(|(_, agrees)| !agrees)
    }

    /// Episodes begin here and there, or moves slip, or cells are misread: of what is sketched nothing is left but
    /// what only this episode has drawn.
    fn doubt(&mut self) {
        if self.shared {
            *self = Self::default();
        }
        self.doubted = true;
    }

    /// The episode ends.
    pub fn end(&mut self) {
        let doubted = self.doubted;
        if doubted {
            *self = Self::default();
        }
        (self.doubted, self.shared) = (doubted, !doubted);
        (self.here, self.around) = (Place::ORIGIN, None);
    }

    /// Can a sketch look like this?
    pub fn is_sound(&self) -> bool {
        let mut visited = self.visited.iter();
        self.cell_map.is_sound() && visited.all(|place| place.reach() <= FURTHEST)
    }

    /// An action of which nobody can tell what comes of it here; if there is none, the one that leads
    /// toward the nearest goal or free cell in which the robot has not been; any action if there is
    /// none either. Chance decides between several. If `passes_goals`, no goal counts while anything else can be
    /// reached.
    pub fn explore(
        &self,
        motion: &MotionModel,
        feels_bumps: bool,
        passes_goals: bool,
        stream: &mut Stream,
    ) -> Action {
        let mut likely: Vec<Action> = Action::all(motion.actions()).collect();
        let is_untold = |action: &Action| {
            self.around
                .is_some_and(|around| motion.leave_open(*action, &around, feels_bumps))
        };
        let is_new = |place| !self.visited.contains(&place);
        let is_no_goal =
            |place| is_new(place) && self.cell_map.cell_state(place) != Some(CellState::Goal);
        let mut news: Vec<Action> = likely.iter().copied().filter(is_untold).collect();
        if news.is_empty() && passes_goals {
            news = self.nearest(motion, is_no_goal);
        }
        if news.is_empty() {
            news = self.nearest(motion, is_new);
        }
        if !news.is_empty() {
            likely = news;
        }
        *stream.choose(&likely).expect("there is an action")
    }

    /// The first actions of the shortest ways to the nearest places that are sought.
    fn nearest(&self, motion: &MotionModel, is_sought: impl Fn(Place) -> bool) -> Vec<Action> {
        let certain = |action| Some((action, offset(motion.certain(action)?)));
        let moves: Vec<_> = Action::all(motion.actions()).filter_map(certain).collect();
        let mut ways = Ways::default();
        let Some(start) = ways.at(self.here) else {
            return Vec::new();
        };
        *start = Some((0, 0));
        let mut queue = VecDeque::from([self.here]);
        let (mut found, mut firsts) = (u32::MAX, 0);
        while let Some(place) = queue.pop_front() {
            let Some((steps, first)) = ways.at(place).and_then(|way| *way) else {
                continue;
            };
            if steps > found {
                break;
            }
            if is_sought(place) {
                (found, firsts) = (steps, firsts | first);
                continue;
            }
            for &(action, by) in &moves {
                let to = place.plus(by);
                let leads_on = match self.cell_map.cell_state(to) {
                    Some(CellState::Free) => true,
                    // There the episode ends.
                    Some(CellState::Goal) => is_sought(to),
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
                match ways.at(to) {
                    Some(Some(way)) if way.0 == steps + 1 => way.1 |= first,
                    Some(way @ None) => {
                        *way = Some((steps + 1, first));
                        queue.push_back(to);
                    }
                    _ => {}
                }
            }
        }
        let is_first = |action: &Action| firsts >> action.index() & 1 == 1;
        moves.iter().map(|one| one.0).filter(is_first).collect()
    }
}

/// By place: the steps from where a search began, and the first actions of the shortest paths there as bits.
struct Ways(Vec<Option<(u32, u32)>>);

impl Ways {
    /// One place more than a map has, on each side.
    const REACH: i32 = FURTHEST as i32 + 1;
    const SIDE: i32 = 2 * Self::REACH + 1;

    /// The entry of a place; `None` if it is too far away for a map.
    fn at(&mut self, place: Place) -> Option<&mut Option<(u32, u32)>> {
        let [east, north] = [place.east, place.north].map(|along| i32::from(along) + Self::REACH);
        let is_near = [east, north]
            .iter()
            .all(|along| (0..Self::SIDE).contains(along));
        is_near.then(|| &mut self.0[(east * Self::SIDE + north) as usize])
    }
}

impl Default for Ways {
    fn default() -> Self {
        Self(vec![None; (Self::SIDE * Self::SIDE) as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::bump::Bump;
    use crate::agent::estimator::map::place::Vision;

    const EAST: usize = 2;
    const WEST: usize = 6;

    /// A corridor from west to east, of so many cells and with a goal at its western end.
    struct Corridor(usize);

    impl Corridor {
        fn around(&self, at: usize) -> Surroundings {
            let mut around = [CellState::Wall; 8];
            around[WEST] = [CellState::Goal, CellState::Free][usize::from(at > 0)];
            around[EAST] = [CellState::Free, CellState::Wall][usize::from(at + 1 == self.0)];
            around
        }

        /// Takes down an episode that comes by these cells.
        fn walk(&self, sketch: &mut LocalMap, cells: &[usize]) {
            let ways = cells
                .windows(2)
                .map(|way| if way[1] > way[0] { EAST } else { WEST });
            let steps = cells.iter().zip(ways).map(|(at, action)| MapStep {
                around: self.around(*at),
                action: Action::new(action).unwrap(),
                found: 0.0,
                bumped: Bump::No,
            });
            let lasts = std::iter::once(None).chain(steps.map(Some));
            for (at, last) in cells.iter().zip(lasts) {
                sketch.perceive(last.as_ref(), &self.around(*at), &robot());
            }
        }
    }

    fn robot() -> RobotModel {
        RobotModel {
            motion: MotionModel::known(8),
            vision: Vision::LookedUp,
            slip: 1e-4,
            observation_error: 1e-4,
        }
    }

    fn heads(sketch: &LocalMap, passes_goals: bool) -> usize {
        let mut stream = Stream::new(1, 0_u64);
        let motion = MotionModel::known(8);
        let action = sketch.explore(&motion, true, passes_goals, &mut stream);
        action.index()
    }

    #[test]
    fn a_goal_is_walked_past_while_anything_else_is_new() {
        let heads = |cells, passes_goals| {
            let mut sketch = LocalMap::default();
            Corridor(cells).walk(&mut sketch, &[0, 1, 2, 1, 0]);
            heads(&sketch, passes_goals)
        };
        assert_eq!(heads(4, true), EAST);
        assert_eq!(heads(3, true), WEST, "nothing else is new");
        assert_eq!(heads(4, false), WEST, "control");
    }

    /// Where a robot heads from the third cell, if its last episode began in this one and came as far as to the
    /// fifth.
    fn heads_after(begun: usize) -> (usize, LocalMap) {
        let (corridor, mut sketch) = (Corridor(9), LocalMap::default());
        corridor.walk(&mut sketch, &(begun..5).collect::<Vec<_>>());
        sketch.end();
        corridor.walk(&mut sketch, &[2]);
        (heads(&sketch, false), sketch)
    }

    #[test]
    fn what_an_episode_has_seen_is_not_new_in_the_next_if_both_begin_in_the_same_place() {
        let (heads, sketch) = heads_after(2);
        assert_eq!(heads, WEST);
        assert!(sketch.visited.len() == 3 && !sketch.doubted);
        let (_, sketch) = heads_after(0);
        assert!(sketch.visited.len() == 1 && sketch.doubted, "control");
    }
}
