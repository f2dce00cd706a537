/// Returns the action with the greatest mean value, the first of equals; `None` if no rule matches.
/// Each matching rule votes for its action with a weight and a value.
pub fn decide(input: &Input) -> Option<u8> {
    let mut value = [0_u64; ACTIONS];
    let mut weight = [0_u64; ACTIONS];
    for rule in RULES.iter().filter(|rule| rule.condition.matches(input)) {
        value[usize::from(rule.action)] += u64::from(rule.value) * u64::from(rule.weight);
        weight[usize::from(rule.action)] += u64::from(rule.weight);
    }
    let mut best: Option<usize> = None;
    for action in (0..ACTIONS).filter(|&action| weight[action] != 0) {
        let is_greater = |best: usize| {
            u128::from(value[action]) * u128::from(weight[best])
                > u128::from(value[best]) * u128::from(weight[action])
        };
        if best.is_none_or(is_greater) {
            best = Some(action);
        }
    }
    best.map(|action| action as u8)
}
