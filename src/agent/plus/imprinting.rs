//! Imprinting of loop-erased paths, where they returned more than was expected.

use xcs::Xcs;
use xcs::{Action, Percept};

/// The path of an episode: percept, action and reward of each step.
pub(super) type Path = Vec<(Percept, Action, f64)>;

/// Cuts out every detour that leads back to a percept of the path.
pub(super) fn loop_erased(path: &[(Percept, Action, f64)]) -> Path {
    let mut erased: Path = Vec::new();
    for step in path {
        if let Some(met) = erased.iter().position(|(percept, ..)| *percept == step.0) {
            erased.truncate(met);
        }
        erased.push(*step);
    }
    erased
}

/// Updates the rules of each pair of a successful path toward the return that followed it, but
/// only where that exceeds the present worth (self-imitation, Oh et al. 2018).
pub(super) fn imprint(
    xcs: &mut Xcs,
    path: &[(Percept, Action, f64)],
    gamma: f64,
    beta: f64,
) -> bool {
    let mut exceeded = false;
    let mut return_ = 0.0;
    for (percept, action, reward) in path.iter().rev() {
        return_ = reward + gamma * return_;
        let present = xcs.experienced_worth(percept).get(*action);
        if present.is_none_or(|worth| return_ > worth) {
            let set = xcs.matching_action_set(percept, *action);
            xcs.update(&set, return_, beta);
            exceeded = true;
        }
    }
    exceeded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detours_that_come_back_are_cut_out() {
        let step =
            |at: &str, action: usize| (at.parse().unwrap(), Action::new(action).unwrap(), -1.0);
        // 00 -> 01 -> 10 -> 01 (a loop) -> 11, with a bump at 11.
        let path = [
            step("00", 0),
            step("01", 0),
            step("10", 1),
            step("01", 2),
            step("11", 3),
            step("11", 0),
        ];
        let erased = loop_erased(&path);
        assert_eq!(erased, [step("00", 0), step("01", 2), step("11", 0)]);
    }
}
