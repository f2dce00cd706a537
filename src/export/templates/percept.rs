/// A percept: bit i is bit i % 8 of byte i / 8.
pub type Percept = [u8; PERCEPT_BYTES];
type Input = Percept;
const EMPTY: Percept = [0; PERCEPT_BYTES];

fn set(percept: &mut Percept, bit: usize) {
    percept[bit / 8] |= 1 << (bit % 8);
}
