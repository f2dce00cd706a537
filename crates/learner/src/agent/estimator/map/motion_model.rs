//! The displacement that each action aims at: known, or learned from what successive percepts share.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::place::{CellState, NEIGHBOURS, Surroundings, heading};
use crate::agent::model::slips::each_other;
use xcs::{Action, ByAction, MAX_ACTIONS};

/// The displacements: one cell into each of the eight directions, and none.
pub const DISPLACEMENTS: usize = NEIGHBOURS.len() + 1;
/// A heading that is at least so likely is taken for the action's own.
const CERTAIN: f64 = 0.9;
/// MotionModel that are less likely than this count for nothing ...
const NEGLIGIBLE: f64 = 1e-6;
/// ... but none is ever held for less likely than this, so that every mistake can be found out.
const LEAST: f64 = 1e-9;

/// For each action, how likely it aims at each displacement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MotionModel {
    actions: usize,
    likely: ByAction<[f64; DISPLACEMENTS]>,
}

impl MotionModel {
    /// Of so many actions, none of which is known.
    pub fn unknown(actions: usize) -> Self {
        let likely = [[1.0 / DISPLACEMENTS as f64; DISPLACEMENTS]; MAX_ACTIONS];
        Self { actions, likely }
    }

    /// Of so many actions, all of which are known.
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

    /// The displacements that an action may aim at, and how likely each of them is.
    pub fn of(&self, action: Action) -> impl Iterator<Item = (usize, f64)> + '_ {
        let likely = self.likely[action.index()].iter().copied().enumerate();
        likely.filter(|one| one.1 > NEGLIGIBLE)
    }

    /// The displacement that an action aims at, once it is certain.
    pub fn certain(&self, action: Action) -> Option<usize> {
        let certain = self.of(action).find(|one| one.1 >= CERTAIN);
        certain.map(|one| one.0)
    }

    /// Of all actions the displacements that are certain.
    pub fn all_certain(&self) -> Vec<Option<usize>> {
        let all = Action::all(self.actions);
        all.map(|action| self.certain(action)).collect()
    }

    /// Is the displacement of every action certain?
    pub fn are_certain(&self) -> bool {
        Action::all(self.actions).all(|action| self.certain(action).is_some())
    }

    /// Can nobody tell what will come of an action among these cells: a bump, or into which of the
    /// others it leads? A hidden corner counts as a wall: a bump does not tell the two apart, and to try
    /// again would teach nothing; nor does it teach who feels no bumps whether it aims at a wall or at nothing.
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

    /// An action was chosen that slips so often, and what was perceived before and after it `fits`
    /// so well to each displacement (theorem of Bayes).
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
        // What cannot have happened teaches nothing.
        if sum > 0.0 {
            let weighed = likely.iter_mut().zip(fits);
            weighed.for_each(|(weight, fit)| *weight = (*weight * fit / sum).max(LEAST));
        }
    }

    /// Can motion of so many actions be like this?
    pub fn is_sound(&self, actions: usize) -> bool {
        let is_sound = |likely: &[f64; DISPLACEMENTS]| {
            likely.iter().all(|weight| (0.0..=1.0).contains(weight))
                && (likely.iter().sum::<f64>() - 1.0).abs() < 1e-6
        };
        self.actions == actions && actions <= MAX_ACTIONS && self.likely.iter().all(is_sound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACTION: usize = 3;

    /// What is believed of one action, after so many steps that fit only to displacement 5, and
    /// some that slipped to displacement 2.
    fn after(steps: u32, slips: u32) -> (MotionModel, Action) {
        let action = Action::new(ACTION).unwrap();
        let mut motion = MotionModel::unknown(8);
        let only = |at: usize| std::array::from_fn(|other| if other == at { 1.0 } else { 1e-4 });
        (0..slips).for_each(|_| motion.learn(action, &only(2), 0.25));
        (0..steps).for_each(|_| motion.learn(action, &only(5), 0.25));
        (motion, action)
    }

    #[test]
    fn a_heading_is_certain_after_some_steps_also_if_others_slipped() {
        for slips in [0, 2] {
            let (motion, action) = after(6, slips);
            assert_eq!(motion.certain(action), Some(5), "{motion:?}");
            assert!(motion.is_sound(8));
        }
    }

    #[test]
    fn control_nothing_is_certain_at_first_and_of_actions_that_were_never_chosen() {
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
    fn what_comes_of_an_action_is_open_only_where_its_headings_lead_to_different_ends() {
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
    fn who_feels_no_bumps_does_not_try_again_whether_an_action_aims_at_a_wall_or_at_nothing() {
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
    fn what_cannot_have_happened_teaches_nothing() {
        let (mut motion, action) = after(6, 0);
        let before = motion;
        motion.learn(action, &[0.0; DISPLACEMENTS], 0.0);
        assert_eq!(motion, before);
        motion.learn(action, &[0.5; DISPLACEMENTS], 0.0);
        assert!(motion.is_sound(8), "control");
    }
}
