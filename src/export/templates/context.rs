/// A percept in the form that a tracker takes: the first sixteen bits, the first one lowest.
pub type Percept = u16;
type Input = Context;
const EMPTY: Percept = 0;

fn set(percept: &mut Percept, bit: usize) {
    if bit < 16 {
        *percept |= 1 << bit;
    }
}

/// A state: a cell of a map, and the rewards collected so far.
#[derive(Clone, Copy)]
pub struct State {
    /// The state that each action leads to, or `GOAL`.
    pub next: [u16; ACTIONS],
    /// The percept in this state.
    pub percept: u16,
    /// Cells to the east of the goal.
    pub x: i8,
    /// Cells to the north of the goal.
    pub y: i8,
    /// The number of the map. Each map is drawn around one goal.
    pub map: u8,
    /// A bit mask of the rewards of the map that were collected.
    pub collected: u8,
}

/// The input of the rules. A step is 1 + 2 * action + 16 * percept, or 0 if there was none.
#[derive(Clone, Copy, Default)]
pub struct Context {
    /// The last step.
    pub last: u32,
    /// The step before the last.
    pub before: u32,
    /// The percept; with observation errors, the percept of the likeliest state.
    pub percept: u16,
    /// Of the likeliest state: cells to the east of the goal.
    pub x: i8,
    /// Cells to the north of the goal.
    pub y: i8,
    /// The number of the map.
    pub map: u8,
    /// A bit mask of the rewards of the map that were collected.
    pub collected: u8,
}

/// The contexts that a rule matches: the least and the greatest coordinates; for all other parts a
/// mask of the demanded bits, and their values.
struct Condition {
    percept: [u16; 2],
    x: [i8; 2],
    y: [i8; 2],
    map: [u8; 2],
    collected: [u8; 2],
    last: [u32; 2],
    before: [u32; 2],
}

impl Condition {
    fn matches(&self, context: &Context) -> bool {
        let within = |[least, most]: [i8; 2], coordinate: i8| (least..=most).contains(&coordinate);
        within(self.x, context.x)
            && within(self.y, context.y)
            && context.percept & self.percept[0] == self.percept[1]
            && context.map & self.map[0] == self.map[1]
            && context.collected & self.collected[0] == self.collected[1]
            && context.last & self.last[0] == self.last[1]
            && context.before & self.before[0] == self.before[1]
    }
}
