//! Frontier exploration: a local map of visited cells, and paths to unvisited ones.
//!
//! Percepts have no places, so that [`exploration`](super::exploration) searches a learned transition model instead,
//! and weighs costs.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, VecDeque};

use foldhash::fast::FixedState;
use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::cell_counts::{CellCounts, FURTHEST};
use crate::agent::estimator::map::motion_model::MotionModel;
use crate::agent::estimator::map::place::{CellState, Place, Surroundings, offset};
use crate::agent::estimator::map::robot_model::{MapStep, RobotModel, likeliest_move};
use xcs::Action;
use xcs::random::Stream;

/// A local map of visited cells, relative to the cell where episodes begin. While observations agree, all episodes
/// are assumed to begin in one cell and share a map. After a contradiction, each episode has its own map.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LocalMap {
    cell_map: CellCounts,
    visited: BTreeSet<Place>,
    /// True if the map contains earlier episodes, too.
    shared: bool,
    /// True if an observation contradicted the map.
    contradicted: bool,
    #[serde(skip)]
    here: Place,
    /// The surroundings perceived here.
    #[serde(skip)]
    around: Option<Surroundings>,
}

impl LocalMap {
    /// Adds the surroundings perceived after a step (`last`), or at the beginning of an episode.
    pub fn perceive(&mut self, last: Option<&MapStep>, around: &Surroundings, robot: &RobotModel) {
        if let Some(last) = last {
            self.here = self.here.plus(likeliest_move(last, around, robot));
        }
        if !self.contradicted && self.contradicts(around) {
            self.drop_shared_map();
        }
        self.around = Some(*around);
        self.cell_map.add(self.here, around);
        if self.here.reach() <= FURTHEST {
            self.visited.insert(self.here);
        }
    }

    /// Returns true if the surroundings contradict the map.
    fn contradicts(&self, around: &Surroundings) -> bool {
        let mut cells = self.cell_map.compare(self.here, around);
        self.cell_map.cell_state(self.here) == Some(CellState::Wall)
            || cells.any(|(_, agrees)| !agrees)
    }

    /// Handles a contradiction: episodes begin in different cells, moves slip or observations have errors. Drops a
    /// map that is shared with earlier episodes.
    fn drop_shared_map(&mut self) {
        if self.shared {
            *self = Self::default();
        }
        self.contradicted = true;
    }

    /// Ends the episode.
    pub fn end(&mut self) {
        let contradicted = self.contradicted;
        if contradicted {
            *self = Self::default();
        }
        (self.contradicted, self.shared) = (contradicted, !contradicted);
        (self.here, self.around) = (Place::ORIGIN, None);
    }

    /// Returns an action whose outcome here is unknown. If there is none, returns the first action toward the nearest
    /// unvisited goal or free cell. If there is none either, returns any action. Ties are broken at random. With
    /// `passes_goals`, goals count only if nothing else is reachable.
    pub fn explore(
        &self,
        motion: &MotionModel,
        feels_bumps: bool,
        passes_goals: bool,
        stream: &mut Stream,
    ) -> Action {
        let mut likely: Vec<Action> = Action::all(motion.actions()).collect();
        let is_unknown = |action: &Action| {
            self.around
                .is_some_and(|around| motion.leave_open(*action, &around, feels_bumps))
        };
        let is_new = |place| !self.visited.contains(&place);
        let is_no_goal =
            |place| is_new(place) && self.cell_map.cell_state(place) != Some(CellState::Goal);
        let mut preferred: Vec<Action> = likely.iter().copied().filter(is_unknown).collect();
        if preferred.is_empty() && passes_goals {
            preferred = self.nearest(motion, is_no_goal);
        }
        if preferred.is_empty() {
            preferred = self.nearest(motion, is_new);
        }
        if !preferred.is_empty() {
            likely = preferred;
        }
        *stream.choose(&likely).expect("there is an action")
    }

    /// Returns the first actions of the shortest paths to the nearest cells that `is_sought`
    /// accepts.
    fn nearest(&self, motion: &MotionModel, is_sought: impl Fn(Place) -> bool) -> Vec<Action> {
        let certain = |action| Some((action, offset(motion.certain(action)?)));
        let moves: Vec<_> = Action::all(motion.actions()).filter_map(certain).collect();
        let mut paths = ShortestPaths::default();
        paths.insert(self.here, (0, 0));
        let mut queue = VecDeque::from([self.here]);
        let (mut found, mut firsts) = (u32::MAX, 0);
        while let Some(place) = queue.pop_front() {
            let (steps, first) = paths[&place];
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
                    // The episode would end there.
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
                match paths.entry(to) {
                    Entry::Occupied(mut path) if path.get().0 == steps + 1 => {
                        path.get_mut().1 |= first;
                    }
                    Entry::Occupied(_) => {}
                    Entry::Vacant(path) => {
                        path.insert((steps + 1, first));
                        queue.push_back(to);
                    }
                }
            }
        }
        let is_first = |action: &Action| firsts >> action.index() & 1 == 1;
        moves.iter().map(|one| one.0).filter(is_first).collect()
    }
}

/// By cell: the number of steps from the start of a search, and the first actions of the shortest paths as bits.
type ShortestPaths = HashMap<Place, (u32, u32), FixedState>;

#[cfg(test)]
mod tests {
    use super::*;

    const EAST: usize = 2;
    const WEST: usize = 6;

    /// A corridor from west to east with this many cells, and a goal at its western end.
    struct Corridor(usize);

    impl Corridor {
        fn around(&self, at: usize) -> Surroundings {
            let mut around = [CellState::Wall; 8];
            around[WEST] = [CellState::Goal, CellState::Free][usize::from(at > 0)];
            around[EAST] = [CellState::Free, CellState::Wall][usize::from(at + 1 == self.0)];
            around
        }

        /// Adds an episode that visits these cells.
        fn walk(&self, map: &mut LocalMap, cells: &[usize]) {
            let actions = cells
                .windows(2)
                .map(|pair| if pair[1] > pair[0] { EAST } else { WEST });
            let steps = cells.iter().zip(actions);
            let steps = steps.map(|(at, action)| MapStep::moved(self.around(*at), action));
            let lasts = std::iter::once(None).chain(steps.map(Some));
            for (at, last) in cells.iter().zip(lasts) {
                let robot = RobotModel::known(1e-4, 1e-4);
                map.perceive(last.as_ref(), &self.around(*at), &robot);
            }
        }
    }

    fn heads(map: &LocalMap, passes_goals: bool) -> usize {
        let mut stream = Stream::new(1, 0_u64);
        let motion = MotionModel::known(8);
        let action = map.explore(&motion, true, passes_goals, &mut stream);
        action.index()
    }

    #[test]
    fn a_goal_is_passed_while_any_other_cell_is_new() {
        let heads = |cells, passes_goals| {
            let mut map = LocalMap::default();
            Corridor(cells).walk(&mut map, &[0, 1, 2, 1, 0]);
            heads(&map, passes_goals)
        };
        assert_eq!(heads(4, true), EAST);
        assert_eq!(heads(3, true), WEST, "nothing else is new");
        assert_eq!(heads(4, false), WEST, "control");
    }

    #[test]
    fn no_path_leads_through_a_goal() {
        let mut map = LocalMap::default();
        Corridor(4).walk(&mut map, &[0, 1, 2, 1, 0]);
        // A cell beyond the goal was seen, which is nearer than the end of the corridor.
        let mut around = [CellState::Wall; 8];
        around[EAST] = CellState::Goal;
        map.cell_map.add(Place::new(-2, 0), &around);
        assert_eq!(heads(&map, true), EAST);
    }

    /// Returns the heading of a robot in the third cell whose last episode went from cell `begun` to the fifth cell.
    fn heads_after(begun: usize) -> (usize, LocalMap) {
        let (corridor, mut map) = (Corridor(9), LocalMap::default());
        corridor.walk(&mut map, &(begun..5).collect::<Vec<_>>());
        map.end();
        corridor.walk(&mut map, &[2]);
        (heads(&map, false), map)
    }

    #[test]
    fn cells_seen_in_one_episode_are_not_new_in_the_next_if_both_begin_in_the_same_cell() {
        let (heads, map) = heads_after(2);
        assert_eq!(heads, WEST);
        assert!(map.visited.len() == 3 && !map.contradicted);
        let (_, map) = heads_after(0);
        assert!(map.visited.len() == 1 && map.contradicted, "control");
    }
}
