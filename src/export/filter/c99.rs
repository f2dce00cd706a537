//! The filter in C99.

use std::fmt::Write;

use super::Addition;
use super::places::{Filter, Line, Place};
use super::usage::{Calls, ROUNDING, costs, usage};
use crate::export::Ballot;
use crate::export::comments::C as COMMENTS;

/// How to use it.
const CALLS: Calls = Calls {
    begin: "call xcscr_reset(&filter)",
    step: "action = xcscr_perceive(&filter, percept, bumped);",
    none: "XCSCR_NO_ACTION",
};

/// The types.
const TYPES: &str = r"
/* A place: all cells that look alike. */
struct xcscr_place {
    double begin;                         /* how likely an episode begins there */
    double open;                          /* the weight of that an action leads there although it never
                                             did, in tries */
    uint32_t tries[XCSCR_ACTIONS];        /* how often each action was tried there */
    uint32_t first;                       /* the first line on what came of them */
    uint16_t lines;                       /* and how many there are */
    uint8_t begun;                        /* did an episode ever begin there? */
    uint8_t percept[XCSCR_PERCEPT_BYTES]; /* what it looks like */
};

/* What came of an action, and how often. */
struct xcscr_line {
    uint32_t count;
    uint16_t to; /* the place to which it led, or XCSCR_BUMPED */
    uint8_t action;
};

/* What is remembered of an episode. */
struct xcscr_filter {
    double belief[XCSCR_PLACES + 1]; /* how likely each place is, beside the likeliest */
    double next[XCSCR_PLACES + 1];   /* the same while it is being computed */
    int8_t action;                   /* what is done, or XCSCR_NO_ACTION */
};
";

/// The functions.
const FUNCTIONS: &str = r"
static inline struct xcscr_place xcscr_place(uint16_t at)
{
    struct xcscr_place place;
    XCSCR_READ(place, xcscr_places[at]);
    return place;
}

/* In how many bits a percept differs from that of a place. */
static inline uint16_t xcscr_differences(const uint8_t percept[XCSCR_PERCEPT_BYTES], uint16_t at)
{
    const struct xcscr_place place = xcscr_place(at);
    uint16_t differences = 0;
    uint8_t byte;

    for (byte = 0; byte < XCSCR_PERCEPT_BYTES; byte++) {
        uint8_t bits = (uint8_t)(percept[byte] ^ place.percept[byte]);
        for (; bits != 0; bits = (uint8_t)(bits & (bits - 1))) {
            differences++;
        }
    }
    return differences;
}

/* How likely this is to be seen in a place, beside what looks like it. */
static inline double xcscr_look(const uint8_t percept[XCSCR_PERCEPT_BYTES], uint16_t at)
{
    double look = 1.0;
    if (at != XCSCR_PLACES) {
        XCSCR_READ(look, xcscr_looks[xcscr_differences(percept, at)]);
    }
    return look;
}

/* Does a place come to mind when this is seen? One that was never met does if none looks just so. */
static inline int xcscr_comes_to_mind(const uint8_t percept[XCSCR_PERCEPT_BYTES], uint16_t at)
{
    if (at != XCSCR_PLACES) {
        return xcscr_differences(percept, at) <= {NEAR};
    }
    for (at = 0; at < XCSCR_PLACES; at++) {
        if (xcscr_differences(percept, at) == 0) {
            return 0;
        }
    }
    return 1;
}

/* How often this came of an action. */
static inline uint32_t xcscr_count(uint16_t from, int8_t action, uint16_t to)
{
    const struct xcscr_place place = xcscr_place(from);
    uint16_t at;

    for (at = 0; at < place.lines; at++) {
        struct xcscr_line line;
        XCSCR_READ(line, xcscr_lines[place.first + at]);
        if (line.action == action && line.to == to) {
            return line.count;
        }
    }
    return 0;
}

/* How likely this is to come of an action. */
static inline double xcscr_chance(uint16_t from, int8_t action, uint16_t to)
{
    const double open = to == XCSCR_BUMPED ? {OPEN_BUMP} : xcscr_place(to).open;
    const double count = (double)xcscr_count(from, action, to);
    const double tries = (double)xcscr_place(from).tries[action];
    return (count + open) / (tries + {OPEN});
}

/* Weighs where an episode may begin. */
static inline void xcscr_begin(struct xcscr_filter *filter,
                               const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    uint16_t at;

    for (at = 0; at <= XCSCR_PLACES; at++) {
        const struct xcscr_place place = xcscr_place(at);
        const int fits = place.begun || xcscr_comes_to_mind(percept, at);
        filter->next[at] = fits ? place.begin * xcscr_look(percept, at) : 0.0;
    }
}

/* The same after a collision: the robot is where it was. */
static inline void xcscr_stay(struct xcscr_filter *filter,
                              const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    uint16_t at;

    for (at = 0; at <= XCSCR_PLACES; at++) {
        filter->next[at] = 0.0;
        if (filter->belief[at] > 0.0) {
            const double bumps = xcscr_chance(at, filter->action, XCSCR_BUMPED);
            filter->next[at] = filter->belief[at] * bumps * xcscr_look(percept, at);
        }
    }
}

/* Where the last action led in more than half of its tries from the only place that is believed, if
 * that looks just like this; XCSCR_PLACES if there is no such place. */
static inline uint16_t xcscr_foreseen(const struct xcscr_filter *filter,
                                      const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    uint16_t from = XCSCR_PLACES;
    uint16_t at;

    for (at = 0; at <= XCSCR_PLACES; at++) {
        if (filter->belief[at] > 0.0) {
            if (from != XCSCR_PLACES || at == XCSCR_PLACES) {
                return XCSCR_PLACES;
            }
            from = at;
        }
    }
    for (at = 0; at < XCSCR_PLACES; at++) {
        if (xcscr_differences(percept, at) == 0
            && 2 * xcscr_count(from, filter->action, at) > xcscr_place(from).tries[filter->action]) {
            return at;
        }
    }
    return XCSCR_PLACES;
}

/* Marks with 0 the places where the robot may be, and all others with -1. */
static inline void xcscr_mark(struct xcscr_filter *filter,
                              const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    uint16_t from;

    for (from = 0; from <= XCSCR_PLACES; from++) {
        filter->next[from] = xcscr_comes_to_mind(percept, from) ? 0.0 : -1.0;
    }
    for (from = 0; from < XCSCR_PLACES; from++) {
        const struct xcscr_place place = xcscr_place(from);
        uint16_t at;
        for (at = 0; at < place.lines && filter->belief[from] > 0.0; at++) {
            struct xcscr_line line;
            XCSCR_READ(line, xcscr_lines[place.first + at]);
            if (line.action == filter->action && line.to != XCSCR_BUMPED) {
                filter->next[line.to] = 0.0;
            }
        }
    }
}

/* Weighs where the robot may be after a move. */
static inline void xcscr_move(struct xcscr_filter *filter,
                              const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    const uint16_t foreseen = xcscr_foreseen(filter, percept);
    uint16_t from;
    uint16_t to;

    if (foreseen != XCSCR_PLACES) {
        for (to = 0; to <= XCSCR_PLACES; to++) {
            filter->next[to] = to == foreseen;
        }
        return;
    }
    xcscr_mark(filter, percept);
    for (from = 0; from <= XCSCR_PLACES; from++) {
        for (to = 0; to <= XCSCR_PLACES && filter->belief[from] > 0.0; to++) {
            if (filter->next[to] >= 0.0) {
                filter->next[to] += filter->belief[from] * xcscr_chance(from, filter->action, to);
            }
        }
    }
    for (to = 0; to <= XCSCR_PLACES; to++) {
        filter->next[to] = filter->next[to] >= 0.0 ? filter->next[to] * xcscr_look(percept, to) : 0.0;
    }
}

/* Believes what was weighed, beside the likeliest place, and forgets what is negligible. */
static inline void xcscr_settle(struct xcscr_filter *filter)
{
    double greatest = 0.0;
    uint16_t at;

    for (at = 0; at <= XCSCR_PLACES; at++) {
        greatest = filter->next[at] > greatest ? filter->next[at] : greatest;
    }
    for (at = 0; at <= XCSCR_PLACES; at++) {
        const double weight = filter->next[at];
        const int counts = weight > 0.0 && weight >= {NEGLIGIBLE} * greatest;
        filter->belief[at] = counts ? weight / greatest : 0.0;
    }
}

/* The likeliest place, the first of several; XCSCR_PLACES if that was never met. */
static inline uint16_t xcscr_likeliest(const struct xcscr_filter *filter)
{
    double most = 0.0;
    uint16_t likeliest = XCSCR_PLACES;
    uint16_t at;

    for (at = 0; at <= XCSCR_PLACES; at++) {
        if (filter->belief[at] > most) {
            most = filter->belief[at];
            likeliest = at;
        }
    }
    return likeliest;
}

/* An episode begins. */
static inline void xcscr_reset(struct xcscr_filter *filter)
{
    uint16_t at;

    for (at = 0; at <= XCSCR_PLACES; at++) {
        filter->belief[at] = 0.0;
        filter->next[at] = 0.0;
    }
    filter->action = XCSCR_NO_ACTION;
}

/* The action for what is perceived now, after the action before it. */
static inline int8_t xcscr_perceive(struct xcscr_filter *filter,
                                    const uint8_t percept[XCSCR_PERCEPT_BYTES], int bumped)
{
    struct xcscr_place place;
    uint16_t likeliest;

    if (filter->action == XCSCR_NO_ACTION) {
        xcscr_begin(filter, percept);
    } else if (bumped) {
        xcscr_stay(filter, percept);
    } else {
        xcscr_move(filter, percept);
    }
    xcscr_settle(filter);
    likeliest = xcscr_likeliest(filter);
    place = xcscr_place(likeliest);
    filter->action = xcscr_decide(likeliest == XCSCR_PLACES ? percept : place.percept);
    return filter->action;
}
";

/// What it adds to a header.
pub fn addition(ballot: &Ballot, filter: &Filter) -> Addition {
    let costs = costs(ballot, filter);
    Addition {
        usage: COMMENTS.of(&[&usage(&CALLS), &costs, ROUNDING].concat()),
        code: [
            &figures(filter),
            TYPES,
            &tables(filter, ballot.bytes()),
            &filter.figures_in(FUNCTIONS),
        ]
        .concat(),
    }
}

fn figures(filter: &Filter) -> String {
    format!(
        "\n#define XCSCR_PLACES {} /* known ones; as a number any that was never met */\n\
         #define XCSCR_BUMPED 65535 /* in place of a place: the robot stayed where it was */\n",
        filter.met()
    )
}

/// All that is known.
fn tables(filter: &Filter, bytes: usize) -> String {
    let mut first = 0;
    let mut places = String::new();
    for place in filter.places() {
        let _ = writeln!(places, "    {},", row(place, first, bytes));
        first += place.came.len();
    }
    let mut lines: String = filter.lines().map(line).collect();
    // C knows no empty tables.
    if lines.is_empty() {
        lines.push_str("    {0u, XCSCR_BUMPED, 0},\n");
    }
    let looks: String = filter
        .looks
        .iter()
        .map(|look| format!("    {look:?},\n"))
        .collect();
    format!(
        "\n/* All places, and one for any that was never met. */\n\
         static const struct xcscr_place xcscr_places[XCSCR_PLACES + 1] XCSCR_TABLE = {{\n{places}}};\n\n\
         /* What came of actions, place by place. */\n\
         static const struct xcscr_line xcscr_lines[] XCSCR_TABLE = {{\n{lines}}};\n\n\
         /* How likely so many bits are misread, beside that none is. */\n\
         static const double xcscr_looks[] XCSCR_TABLE = {{\n{looks}}};\n"
    )
}

fn row(place: &Place, first: usize, bytes: usize) -> String {
    let tries: Vec<String> = place
        .tries
        .iter()
        .map(|tries| format!("{tries}u"))
        .collect();
    let bytes: Vec<String> = place
        .bytes(bytes)
        .iter()
        .map(|byte| format!("0x{byte:02x}"))
        .collect();
    format!(
        "{{{:?}, {:?}, {{{}}}, {first}u, {}, {}, {{{}}}}}",
        place.begin,
        place.open,
        tries.join(", "),
        place.came.len(),
        u8::from(place.begun),
        bytes.join(", ")
    )
}

fn line(line: &Line) -> String {
    let Line { action, count, .. } = line;
    format!("    {{{count}u, {}, {action}}},\n", line.to("XCSCR_BUMPED"))
}
