//! Executed policies, and their paths without loops.

use crate::agent::Transition;
use xcs::{Action, Percept};
use xcscr_robot::world::Cell;

/// Where an action was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// The estimated cell of the robot.
    Cell(Cell),
    /// The whole percept, in an environment without cells.
    Percept(Percept),
}

impl Place {
    /// Returns the place of a step.
    pub fn of(step: &Transition<'_>) -> Self {
        step.place.map_or(Self::Percept(*step.percept), Self::Cell)
    }
}

/// A step of an executed policy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PolicyStep {
    pub place: Place,
    pub percept: Percept,
    pub action: Action,
}

/// An executed policy, first step first.
pub(super) type Policy = Vec<PolicyStep>;

/// Returns the path of an episode without its loops: whenever the robot is back in a place, the steps since the first
/// visit are dropped. The path was driven, leads to the same place, and visits no place twice.
///
/// The paper stores executed policies as they are (Alg. 3). Loop erasure is common in ant colony optimisation (Dorigo
/// and Stützle 2004, section 1.3).
pub(super) fn without_loops(policy: Policy) -> Policy {
    let mut path = Policy::new();
    for step in policy {
        if let Some(first) = path.iter().position(|known| known.place == step.place) {
            path.truncate(first);
        }
        path.push(step);
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a policy that takes an action in each of these columns.
    fn policy(steps: &[(u16, usize)]) -> Policy {
        let step = |&(col, action): &(u16, usize)| PolicyStep {
            place: Place::Cell(Cell { col, row: 1 }),
            percept: "01".parse().unwrap(),
            action: Action::new(action).unwrap(),
        };
        steps.iter().map(step).collect()
    }

    #[test]
    fn the_steps_between_two_visits_to_a_cell_are_dropped() {
        // A collision in column 1, then a loop over 2 and 3 back to 2.
        let driven = [(1, 0), (1, 1), (2, 1), (3, 3), (2, 2), (4, 1)];
        let path = [(1, 1), (2, 2), (4, 1)];
        assert_eq!(without_loops(policy(&driven)), policy(&path));
    }

    #[test]
    fn a_path_without_loops_stays_as_it_is() {
        let path = [(1, 1), (2, 2), (4, 1)];
        assert_eq!(without_loops(policy(&path)), policy(&path));
    }

    #[test]
    fn cells_with_the_same_percept_are_different_places() {
        // All percepts are equal: by percept, only the last step would be left.
        let path = policy(&[(1, 1), (2, 2), (4, 1)]);
        assert_eq!(without_loops(path.clone()).len(), 3);
        let by_percept = path.into_iter().map(|step| PolicyStep {
            place: Place::Percept(step.percept),
            ..step
        });
        assert_eq!(without_loops(by_percept.collect()).len(), 1, "control");
    }
}
