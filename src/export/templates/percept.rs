/// A percept: bit i is bit i % 8 of byte i / 8.
pub type Percept = [u8; PERCEPT_BYTES];
type Input = Percept;
const EMPTY: Percept = [0; PERCEPT_BYTES];

fn set(percept: &mut Percept, bit: usize) {
    percept[bit / 8] |= 1 << (bit % 8);
}

/// The percepts that a rule matches: for each byte a mask of the demanded bits, and their values.
struct Condition([[u8; 2]; PERCEPT_BYTES]);

impl Condition {
    fn matches(&self, percept: &Percept) -> bool {
        let mut bytes = percept.iter().zip(&self.0);
        bytes.all(|(byte, [mask, value])| byte & mask == *value)
    }
}
