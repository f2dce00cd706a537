//! Planning on the map by simulated episodes.

use super::{Learned, MapLearner};
use crate::agent::planner::rtdp_bel::Effort;

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

impl MapLearner {
    /// Plans by simulating episodes. Returns true if the plan changed.
    pub(super) fn plan(&mut self) -> bool {
        match self.map.pomdp.slip() > 0.0 {
            true => self.plan_from_random_states(),
            false => self.plan_from_all_states(),
        }
    }

    /// Plans from every state until nothing changes any more.
    fn plan_from_all_states(&mut self) -> bool {
        let mut changed = false;
        for _ in 0..SWEEPS {
            let mut change = 0.0_f64;
            for start in 0..self.map.starts() {
                let effort = self.simulate(start);
                change = change.max(effort.change);
            }
            if change < 1e-9 {
                break;
            }
            self.learned.met.clear();
            changed = true;
        }
        changed
    }

    /// Plans from randomly drawn states.
    fn plan_from_random_states(&mut self) -> bool {
        let states = self.map.starts() as usize;
        let budget = WEIGHED[usize::from(self.learned.episodes > EARLY)];
        let mut weighed = 0;
        for _ in 0..SIMULATED {
            let start = self.learned.stream.below(states) as u32;
            weighed += self.simulate(start).weighed;
            if weighed > budget {
                break;
            }
        }
        REVISED_AFTER.contains(&self.learned.episodes)
    }

    fn simulate(&mut self, start: u32) -> Effort {
        let belief = self.map.first_belief(start);
        let Learned {
            planner, stream, ..
        } = &mut self.learned;
        planner.simulate(&self.map.pomdp, start, belief, stream)
    }
}
