//! The motion model: the displacement of each action, either known or learned from successive percepts.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::place::{CellState, NEIGHBOURS, Surroundings, heading};
use xcs::{Action, ByAction, MAX_ACTIONS};
use xcscr_robot::world::each_other;

/// The displacements: one cell in each of the eight directions, and none.
pub const DISPLACEMENTS: usize = NEIGHBOURS.len() + 1;
/// The minimum probability at which a displacement counts as certain.
const CERTAIN: f64 = 0.9;
/// Displacements less likely than this are ignored ...
const NEGLIGIBLE: f64 = 1e-6;
/// ... but no probability falls below this, so that every error can be corrected.
const LEAST: f64 = 1e-9;

/// For each action, the probability of each displacement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MotionModel {
    actions: usize,
    likely: ByAction<[f64; DISPLACEMENTS]>,
}

impl MotionModel {
    /// The uniform model for `actions` actions.
    pub fn unknown(actions: usize) -> Self {
        let likely = [[1.0 / DISPLACEMENTS as f64; DISPLACEMENTS]; MAX_ACTIONS];
        Self { actions, likely }
    }

    /// The known model for `actions` actions.
    pub fn known(actions: usize) -> Self {
        let mut known = Self::unknown(actions);
        for action in Action::all(actions) {
            let likely = &mut known.likely[action.index()];
            *likely = [0.0; DISPLACEMENTS];
            likely[heading(action, actions)] = 1.0;
        }
        known
    }

    /// The number of actions.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Returns the possible displacements of an action with their probabilities.
    pub fn of(&self, action: Action) -> impl Iterator<Item = (usize, f64)> + '_ {
        let likely = self.likely[action.index()].iter().copied().enumerate();
        likely.filter(|one| one.1 > NEGLIGIBLE)
    }

    /// Returns the displacement of an action if it is certain.
    pub fn certain(&self, action: Action) -> Option<usize> {
        let certain = self.of(action).find(|one| one.1 >= CERTAIN);
        certain.map(|one| one.0)
    }

    /// Returns the displacements of all actions that are certain.
    pub fn all_certain(&self) -> Vec<Option<usize>> {
        let all = Action::all(self.actions);
        all.map(|action| self.certain(action)).collect()
    }

    /// Returns true if the displacement of every action is certain.
    pub fn are_certain(&self) -> bool {
        Action::all(self.actions).all(|action| self.certain(action).is_some())
    }

    /// Returns true if the result of an action among these cells is uncertain: a bump, or one of several
    /// moves. A hidden corner counts as a wall: a bump does not distinguish the two, so another try would
    /// carry no information. Without a bumper, a wall ahead and no displacement count as the same result, too.
    pub fn leave_open(&self, action: Action, around: &Surroundings, feels_bumps: bool) -> bool {
        let bars = |heading: usize| match around.get(heading) {
            Some(state) => matches!(state, CellState::Wall | CellState::Hidden),
            None => !feels_bumps,
        };
        let bumps = self.of(action).filter(|one| bars(one.0));
        let moves = self.of(action).filter(|one| !bars(one.0));
        let bump: f64 = bumps.map(|one| one.1).sum();
        moves.map(|one| one.1).fold(bump, f64::max) < CERTAIN
    }

    /// Updates the model of a chosen action by Bayes' theorem. `fits` is the likelihood of the percepts
    /// before and after it, by displacement; `slip` is the slip probability.
    pub fn learn(&mut self, action: Action, fits: &[f64; DISPLACEMENTS], slip: f64) {
        let others = Action::all(self.actions).filter(|&other| other != action);
        let others = others.flat_map(|other| self.of(other));
        let fits_others: f64 = others.map(|(at, weight)| weight * fits[at]).sum();
        let slipped = each_other(slip, self.actions) * fits_others;
        let likely = &mut self.likely[action.index()];
        let fits = fits.map(|fit| (1.0 - slip) * fit + slipped);
        let sum: f64 = likely
            .iter()
            .zip(fits)
            .map(|(weight, fit)| weight * fit)
            .sum();
        // An impossible observation carries no information.
        if sum > 0.0 {
            let weighed = likely.iter_mut().zip(fits);
            weighed.for_each(|(weight, fit)| *weight = (*weight * fit / sum).max(LEAST));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACTION: usize = 3;

    /// Returns the model of one action after `steps` steps that fit only displacement 5, and `slips`
    /// slips that fit displacement 2.
    fn after(steps: u32, slips: u32) -> (MotionModel, Action) {
        let action = Action::new(ACTION).unwrap();
        let mut motion = MotionModel::unknown(8);
        let only = |at: usize| std::array::from_fn(|other| if other == at { 1.0 } else { 1e-4 });
        (0..slips).for_each(|_| motion.learn(action, &only(2), 0.25));
        (0..steps).for_each(|_| motion.learn(action, &only(5), 0.25));
        (motion, action)
    }

    #[test]
    fn a_heading_is_certain_after_some_steps_even_if_others_slipped() {
        for slips in [0, 2] {
            let (motion, action) = after(6, slips);
            assert_eq!(motion.certain(action), Some(5), "{motion:?}");
        }
    }

    #[test]
    fn control_nothing_is_certain_at_first_or_for_actions_that_were_never_chosen() {
        assert_eq!(after(0, 0).0.all_certain(), [None; 8]);
        let (motion, action) = after(6, 0);
        let others = Action::all(8).filter(|other| *other != action);
        assert!(
            others
                .into_iter()
                .all(|other| motion.certain(other).is_none())
        );
    }

    #[test]
    fn the_result_of_an_action_is_open_only_if_its_headings_lead_to_different_results() {
        let (mut motion, action) = after(6, 0);
        let mut around = [CellState::Wall; 8];
        assert!(!motion.leave_open(action, &around, true));
        let other = Action::new(0).unwrap();
        assert!(motion.leave_open(other, &[CellState::Free; 8], true));
        motion = MotionModel::unknown(8);
        motion.learn(other, &[1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
        assert!(!motion.leave_open(other, &around, true), "it bumps");
        around[1] = CellState::Free;
        assert!(motion.leave_open(other, &around, true));
    }

    #[test]
    fn without_a_bumper_a_wall_and_no_displacement_need_not_be_distinguished() {
        let (mut motion, action) = (MotionModel::unknown(8), Action::new(0).unwrap());
        let fits = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        motion.learn(action, &fits, 0.0);
        let walls = [CellState::Wall; 8];
        assert!(!motion.leave_open(action, &walls, false));
        assert!(motion.leave_open(action, &walls, true));
        assert!(
            motion.leave_open(action, &[CellState::Free; 8], false),
            "control"
        );
    }

    #[test]
    fn an_impossible_observation_changes_nothing() {
        let (mut motion, action) = after(6, 0);
        let before = motion;
        motion.learn(action, &[0.0; DISPLACEMENTS], 0.0);
        assert_eq!(motion, before);
        motion.learn(action, &[0.5; DISPLACEMENTS], 0.0);
        let likely = motion.likely.iter().flatten();
        assert!(likely.copied().all(f64::is_finite), "control");
    }
}
