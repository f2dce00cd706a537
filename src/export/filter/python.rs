//! The filter in Python.

use super::Addition;
use super::places::{Filter, Line, Place};
use super::usage::{Calls, usage};
use crate::export::comments::PYTHON as COMMENTS;

/// How to use it.
const CALLS: Calls = Calls {
    begin: "make a Filter()",
    step: "action = filter.perceive(percept, bumped)",
    none: "None",
};

/// The functions.
const FILTER: &str = r#"

def differences(percept, place):
    """In how many bits a percept differs from that of a place."""
    return sum(seen != there for seen, there in zip(percept, PLACES[place][0]))


def look(percept, place):
    """How likely this is to be seen in a place, beside what looks like it."""
    return 1.0 if place == NEVER_MET else LOOKS[differences(percept, place)]


def in_mind(percept, expected):
    """The places where a robot may be that sees this, in order: those that are expected, or look nearly
    like this, and one that was never met if none looks just so."""
    known = range(NEVER_MET)
    places = [place for place in known if place in expected or differences(percept, place) <= {NEAR}]
    return places if any(percept == PLACES[place][0] for place in known) else places + [NEVER_MET]


def chance(start, action, to):
    """How likely this is to come of an action."""
    _, _, _, _, tries, came = PLACES[start]
    open = {OPEN_BUMP} if to == BUMPED else PLACES[to][3]
    return (came.get((action, to), 0) + open) / (tries[action] + {OPEN})


class Filter:
    """What is remembered of an episode."""

    def __init__(self):
        self.belief = {}  # how likely each place is, beside the likeliest
        self.action = None

    def perceive(self, percept, bumped=False):
        """The action for what is perceived now, after the action before it."""
        if self.action is None:
            weights = self.begin(percept)
        elif bumped:
            weights = self.stay(percept)
        else:
            weights = self.move(percept)
        greatest = max(weights.values(), default=0.0)
        self.belief = {
            place: weight / greatest
            for place, weight in weights.items()
            if weight > 0.0 and weight >= {NEGLIGIBLE} * greatest
        }
        place = self.likeliest()
        self.action = decide(percept if place == NEVER_MET else PLACES[place][0])
        return self.action

    def likeliest(self):
        """The likeliest place, the first of several; NEVER_MET if that was never met."""
        return max(self.belief, key=self.belief.get, default=NEVER_MET)

    def begin(self, percept):
        """Weighs where an episode may begin."""
        begun = {place for place in range(NEVER_MET) if PLACES[place][1]}
        return {place: PLACES[place][2] * look(percept, place) for place in in_mind(percept, begun)}

    def stay(self, percept):
        """The same after a collision: the robot is where it was."""
        return {
            place: before * chance(place, self.action, BUMPED) * look(percept, place)
            for place, before in self.belief.items()
        }

    def move(self, percept):
        """Weighs where the robot may be after a move."""
        expected = {
            to
            for start in self.belief
            for action, to in PLACES[start][5]
            if action == self.action and to != BUMPED
        }
        if len(self.belief) == 1:
            (start,) = self.belief
            for to in expected:
                usual = 2 * PLACES[start][5][self.action, to] > PLACES[start][4][self.action]
                if usual and PLACES[to][0] == percept:
                    return {to: 1.0}
        weights = {}
        for place in in_mind(percept, expected):
            weight = 0.0
            for start, before in self.belief.items():
                weight += before * chance(start, self.action, place)
            weights[place] = weight * look(percept, place)
        return weights
"#;

/// What it adds to a module.
pub fn addition(filter: &Filter) -> Addition {
    Addition {
        usage: COMMENTS.of(&usage(&CALLS)),
        code: tables(filter) + &filter.figures_in(FILTER),
    }
}

/// All that is known.
fn tables(filter: &Filter) -> String {
    let places: String = filter.places().map(row).collect();
    let looks: String = filter
        .looks
        .iter()
        .map(|look| format!("    {look:?},\n"))
        .collect();
    format!(
        "\n# In place of a place: the robot stayed where it was.\n\
         BUMPED = -1\n\
         \n# Places: what they look like, whether an episode ever began there, how likely one does, the weight\n\
         # of that an action leads there although it never did (in tries), how often each action was tried,\n\
         # and how often what came of it. The last one stands for any that was never met.\n\
         PLACES = [\n{places}]\n\
         NEVER_MET = len(PLACES) - 1\n\
         \n# How likely so many bits are misread, beside that none is.\n\
         LOOKS = [\n{looks}]\n"
    )
}

fn row(place: &Place) -> String {
    let begun = if place.begun { "True" } else { "False" };
    let came: Vec<String> = place.came.iter().map(line).collect();
    format!(
        "    ({:?}, {begun}, {:?}, {:?}, {:?}, {{{}}}),\n",
        place.percept.map_or(String::new(), String::from),
        place.begin,
        place.open,
        place.tries,
        came.join(", ")
    )
}

fn line(line: &Line) -> String {
    let Line { action, count, .. } = line;
    format!("({action}, {}): {count}", line.to("BUMPED"))
}
