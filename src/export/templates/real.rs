/// The probability of a state.
type Weight = f64;
const NONE: Weight = 0.0;

/// Returns the weights after the chosen action and after each other action.
fn shares(weight: Weight) -> [Weight; 2] {
    [
        weight * (1.0 - SLIP),
        weight * (SLIP / (ACTIONS - 1) as f64),
    ]
}

/// Removes unlikely states and normalises the others to a sum of 1. Returns true if any state is
/// left.
fn settle(belief: &mut [Weight; STATES]) -> bool {
    let sum: f64 = belief.iter().sum();
    let is_unlikely = |weight: &&mut Weight| **weight <= NEGLIGIBLE * sum;
    belief
        .iter_mut()
        .filter(is_unlikely)
        .for_each(|weight| *weight = 0.0);
    let kept: f64 = belief.iter().sum();
    belief
        .iter_mut()
        .filter(|_| kept > 0.0)
        .for_each(|weight| *weight /= kept);
    kept > 0.0
}
