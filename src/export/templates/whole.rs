/// The weight of a state; only the ratios matter. Moves and percepts are without errors.
type Weight = u16;
const NONE: Weight = 0;

/// Returns the weights after the chosen action and after each other action.
fn shares(weight: Weight) -> [Weight; 2] {
    [weight, 0]
}

/// Removes unlikely states. Returns true if any state is left.
fn settle(belief: &mut [Weight; STATES]) -> bool {
    let sum: u32 = belief.iter().map(|&weight| u32::from(weight)).sum();
    let is_unlikely = |weight: &&mut Weight| u32::from(**weight) * NEGLIGIBLE_ONE_IN <= sum;
    belief
        .iter_mut()
        .filter(is_unlikely)
        .for_each(|weight| *weight = 0);
    belief.iter().any(|&weight| weight > 0)
}
