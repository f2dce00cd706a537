def decide(percept, allowed=None):
    """Returns the action with the greatest mean value, the first of equals; None if no rule matches. `allowed`
    are the actions to choose from, by default all. Each matching rule votes for its action with a weight and a
    value."""
    sums = [[0, 0] for _ in ACTIONS]
    for condition, action, weight, value in RULES:
        if matches(condition, percept):
            sums[action][0] += value * weight
            sums[action][1] += weight
    best = None
    for action, (value, weight) in enumerate(sums):
        if weight and (allowed is None or action in allowed) and (best is None or value * sums[best][1] > sums[best][0] * weight):
            best = action
    return best
