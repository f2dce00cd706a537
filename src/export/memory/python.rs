//! Exports the policy with its maps as a Python module.

use std::fmt::Write;

use super::demanded::{Language, expression};
use super::maps::{MapTable, State, named};
use super::usage::{Calls, usage};
use crate::agent::pomdp::NEGLIGIBLE;
use crate::agent::{BEGUN_ELSEWHERE, MISLOCALISED, PERCEPT_BITS};
use crate::export::comments::PYTHON as COMMENTS;
use crate::export::python::names;
use crate::export::{Provenance, QuantisedPolicy, WeightedRule};

/// Python syntax for conditions.
const PYTHON: Language = Language {
    of: "",
    and: " and ",
};

/// Usage in Python.
const CALLS: Calls = Calls {
    begin: "create a Tracker()",
    step: "action = tracker.perceive(percept, bumped, rewarded)",
    percept: " as a number, see BITS",
    none: " None:\ntake ",
};

/// The part that is the same in every module.
const TRACKER: &str = r#"

def decide(context):
    """Returns the action for a context, the first of equals; None if no rule matches."""
    sums = [[0, 0] for _ in ACTIONS]
    for action, weight, value in votes(*context):
        sums[action][0] += value * weight
        sums[action][1] += weight
    best = None
    for action, (value, weight) in enumerate(sums):
        if weight and (best is None or value * sums[best][1] > sums[best][0] * weight):
            best = action
    return best


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
    least = {NEGLIGIBLE} * total(weights[state] for state in sorted(weights))
    kept = [(state, weights[state]) for state in sorted(weights) if weights[state] > least]
    whole = total(weight for _, weight in kept)
    return {state: weight / whole for state, weight in kept}


class Tracker:
    """The state of an episode."""

    def __init__(self):
        self.belief = {} if BEGIN is None else {BEGIN: 1.0}  # the probability of each state
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
        place = (0, 0, 0, 0) if likeliest is None else STATES[likeliest][1:5]
        return (self.percept, *place, self.last, self.before)

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
        if self.action is None:
            expected, mislocalised = self.belief, {BEGUN_ELSEWHERE}
        else:
            self.found = min(self.found + rewarded, REWARDS)
            expected, mislocalised = self.follow({MAY_LEAD}), {MISLOCALISED}
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
"#;

/// Returns the module.
pub fn text(quantised: &QuantisedPolicy, maps: &MapTable, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(quantised, provenance);
    text.push_str(&COMMENTS.of(&usage(&CALLS, maps)));
    text.push_str(
        "\nimport math\n\n# The meaning of each bit of a percept when it is 1, the lowest first.\n",
    );
    text.push_str(&names(quantised, PERCEPT_BITS, provenance));
    text.push('\n');
    text.push_str(&states(maps));
    text.push_str(&rules(quantised, provenance));
    let may_lead = match maps.unfelt {
        true => "lambda *_: True",
        false => "lambda state, to: (to == state) == bumped",
    };
    text.push_str(
        &TRACKER
            .replace("{MAY_LEAD}", may_lead)
            .replace("{NEGLIGIBLE}", &format!("{NEGLIGIBLE:?}"))
            .replace("{MISLOCALISED}", &format!("{MISLOCALISED:?}"))
            .replace("{BEGUN_ELSEWHERE}", &format!("{BEGUN_ELSEWHERE:?}")),
    );
    text
}

/// Returns the maps.
fn states(maps: &MapTable) -> String {
    let begin = named(maps.begin, "None");
    let mut text = format!(
        "# The probabilities that another action is executed and that a cell is observed wrongly, and the number of rewards.\n\
         SLIP = {:?}\nOBSERVATION_ERROR = {:?}\nREWARDS = {}\n\n# The state in which all episodes begin, if there is one.\n\
         BEGIN = {begin}\n\n# States: the percept, cells to the east and to the north of the goal, the number \
         of the map (each is\n# drawn around one goal), the bit mask of rewards, and by action the next \
         state (None: the goal).\nSTATES = [\n",
        maps.slip,
        maps.observation_error,
        maps.rewards()
    );
    for (at, state) in maps.states().iter().enumerate() {
        let State {
            percept,
            x,
            y,
            map,
            collected,
            ..
        } = state;
        let _ = writeln!(
            text,
            "    ({percept:#06x}, {x}, {y}, {map}, {collected}, ({})),  # {at}",
            state.successors("None")
        );
    }
    text.push_str("]\n");
    text
}

/// Returns the rules as statements.
fn rules(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = String::from(
        "\n\ndef votes(percept, x, y, map, collected, last, before):\n    \
         \"\"\"Action, weight and value of each rule that matches.\"\"\"\n",
    );
    for vote in quantised.votes() {
        let WeightedRule {
            condition,
            action,
            value,
            weight,
        } = vote;
        let demands = expression(condition, &PYTHON).unwrap_or("True".to_owned());
        let _ = writeln!(
            text,
            "    # {}: {}\n    if {demands}:\n        yield {}, {weight}, {value}",
            provenance.words(condition),
            provenance.action(*action),
            action.index()
        );
    }
    text
}
