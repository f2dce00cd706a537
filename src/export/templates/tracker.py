def found_in(state):
    """Returns the number of rewards collected in a state."""
    return bin(STATES[state][4]).count("1")


def cell_state(percept, at):
    """Returns the state of one of the eight surrounding cells. The value 1 is not a cell state. It counts
    as 0 (free), because most cells are free."""
    state = percept >> at & 3
    return 0 if state == 1 else state


def differences(a, b):
    """Returns in how many of these cells two percepts differ."""
    return sum(cell_state(a, at) != cell_state(b, at) for at in range(0, 16, 2))


def total(weights):
    """Returns the sum, added one by one: sum() rounds differently in newer versions of Python."""
    total = 0.0
    for weight in weights:
        total += weight
    return total


def settled(weights):
    """Returns the weights without negligible ones, normalised to a sum of 1."""
    least = NEGLIGIBLE * total(weights[state] for state in sorted(weights))
    kept = [(state, weights[state]) for state in sorted(weights) if weights[state] > least]
    whole = total(weight for _, weight in kept)
    return {state: weight / whole for state, weight in kept}


class Tracker:
    """The state of an episode."""

    def __init__(self):
        self.belief = {BEGIN: 1.0} if BEGIN < len(STATES) else {}  # the probability of each state
        self.last = self.before = 0  # steps: 1 + 2 * action + 16 * percept, or 0
        self.percept = 0
        self.action = None
        self.found = 0

    def perceive(self, percept, bumped=False, rewarded=False):
        """Returns the action for a percept. bumped and rewarded describe the result of the last action."""
        if self.action is not None:
            self.before = self.last
            self.last = 1 | self.action << 1 | self.percept << 4
        percept &= 0xFFFF
        if OBSERVATION_ERROR > 0.0:
            self.locate_noisy(percept, bool(bumped), bool(rewarded))
        else:
            self.locate(percept, bool(rewarded))
        self.action = decide(self.context())
        return self.action

    def likeliest(self):
        """Returns the likeliest state, the first of several; None if the belief is empty."""
        return max(self.belief, key=self.belief.get, default=None)

    def context(self):
        """Returns the input of the rules: the percept; of the likeliest state the cells to the east and to
        the north of the goal, the number of the map and the bit mask of rewards; the last two steps."""
        likeliest = self.likeliest()
        x, y, map_number, collected = (0, 0, 0, 0) if likeliest is None else STATES[likeliest][1:5]
        return {
            "percept": self.percept,
            "x": x,
            "y": y,
            "map": map_number,
            "collected": collected,
            "last": self.last,
            "before": self.before,
        }

    def moves(self):
        """Yields each possible transition after the last action: from, to and weight."""
        for state, weight in self.belief.items():
            after = STATES[state][5]
            yield state, after[self.action], weight * (1.0 - SLIP)
            if SLIP > 0.0:
                for action, to in enumerate(after):
                    if action != self.action:
                        yield state, to, weight * (SLIP / (len(ACTIONS) - 1))

    def follow(self, fits):
        """Returns the belief after the last action, from the transitions that fit."""
        weights = {}
        for state, to, weight in self.moves():
            if to is not None and fits(state, to):
                weights[to] = weights.get(to, 0.0) + weight
        return settled(weights)

    def locate(self, percept, rewarded):
        """Updates the belief with an exact percept."""
        self.percept = percept

        def looks(state, found):
            return STATES[state][0] == percept and found_in(state) == found

        if self.action is None:
            if self.belief and all(looks(state, self.found) for state in self.belief):
                return
        else:
            # A reward that was not predicted, or did not come, still gives evidence about the state.
            for found in (self.found + rewarded, self.found + (not rewarded)):
                belief = self.follow(lambda _, to: looks(to, found))
                if belief:
                    self.belief, self.found = belief, found
                    return
            self.found = min(self.found + rewarded, REWARDS)
        strange = {
            state: differences(STATES[state][0], percept)
            for state in range(len(STATES))
            if found_in(state) == self.found
        }
        least = min(strange.values(), default=0)
        self.belief = settled({state: 1.0 for state in strange if strange[state] == least})

    def locate_noisy(self, percept, bumped, rewarded):
        """Updates the belief with a percept that may have errors. Each state is weighted by its prediction
        and by the number of observation errors that it implies. With a small probability the robot is in
        any state."""

        def fits(state, to):
            return IGNORES_COLLISIONS or (to == state) == bumped

        if self.action is None:
            expected, mislocalised = self.belief, BEGUN_ELSEWHERE
        else:
            self.found = min(self.found + rewarded, REWARDS)
            expected, mislocalised = self.follow(fits), MISLOCALISED
        if not expected:
            mislocalised = 1.0
        weights = {}
        for state in range(len(STATES)):
            likely = 1.0
            for _ in range(differences(STATES[state][0], percept) + (found_in(state) != self.found)):
                likely *= OBSERVATION_ERROR
            weight = expected.get(state, 0.0) * (1.0 - mislocalised) + mislocalised / len(STATES)
            weights[state] = weight * likely
        self.belief = settled(weights)
        likeliest = self.likeliest()
        self.percept = percept if likeliest is None else STATES[likeliest][0]
