
/// A percept in the form that a tracker takes: the first sixteen bits, the first one lowest.
pub type Percept = u16;
const EMPTY: Percept = 0;

fn set(percept: &mut Percept, bit: usize) {
    if bit < 16 {
        *percept |= 1 << bit;
    }
}
