//! Planning on a map by simulated episodes between the real ones.

use crate::agent::estimator::map::Map;
use crate::agent::planner::rtdp_bel::{BeliefPlanner, Effort};
use xcs::random::Stream;

/// The maximum number of simulated episodes after each real one, and the maximum number of states
/// evaluated in them, early and later.
const SIMULATED: usize = 32;
const WEIGHED: [usize; 2] = [1600, 500];
/// The number of episodes up to which the greater of these holds.
const EARLY: u32 = 100;
/// The maximum number of simulated episodes per state after each real one, if moves are exact.
const SWEEPS: usize = 8;
/// If moves slip, plans never converge. Rules are distilled again after these episodes.
const REVISED_AFTER: [u32; 14] = [
    25, 50, 75, 100, 150, 200, 250, 300, 400, 500, 600, 700, 800, 900,
];

impl BeliefPlanner {
    /// Plans by simulating episodes, after `episodes` real ones. Returns true if the plan changed enough to distil
    /// rules again.
    pub fn plan(&mut self, map: &Map, episodes: u32, stream: &mut Stream) -> bool {
        match map.pomdp.slip() > 0.0 {
            true => self.plan_from_random_states(map, episodes, stream),
            false => self.plan_from_all_states(map, stream),
        }
    }

    /// Plans from every state until nothing changes any more. Returns true if anything changed.
    fn plan_from_all_states(&mut self, map: &Map, stream: &mut Stream) -> bool {
        for sweep in 0..SWEEPS {
            let mut change = 0.0_f64;
            for start in 0..map.starts() {
                change = change.max(self.simulate_on(map, start, stream).change);
            }
            if change < 1e-9 {
                return sweep > 0;
            }
        }
        true
    }

    /// Plans from randomly drawn states.
    fn plan_from_random_states(&mut self, map: &Map, episodes: u32, stream: &mut Stream) -> bool {
        let budget = WEIGHED[usize::from(episodes > EARLY)];
        let mut weighed = 0;
        for _ in 0..SIMULATED {
            let start = stream.below(map.starts() as usize) as u32;
            weighed += self.simulate_on(map, start, stream).weighed;
            if weighed > budget {
                break;
            }
        }
        REVISED_AFTER.contains(&episodes)
    }

    fn simulate_on(&mut self, map: &Map, start: u32, stream: &mut Stream) -> Effort {
        self.simulate(&map.pomdp, start, map.first_belief(start), stream)
    }

    /// Plans from every state until nothing changes any more if moves are exact, as for the examples of rules.
    pub fn settle_all(&mut self, map: &Map) {
        for start in 0..map.starts() {
            self.settled_costs(&map.pomdp, &map.first_belief(start));
        }
    }
}
