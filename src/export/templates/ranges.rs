/// The percepts that a rule matches: for each byte a mask of the demanded bits, and their values; then
/// the least and the greatest column and row.
struct Condition {
    bytes: [[u8; 2]; PERCEPT_BYTES],
    column: [u16; 2],
    row: [u16; 2],
}

/// The number that some bits of a percept encode, the highest first.
fn number(percept: &Percept, bits: core::ops::Range<usize>) -> u16 {
    bits.fold(0, |number, bit| {
        number << 1 | u16::from(percept[bit / 8] >> (bit % 8) & 1)
    })
}

impl Condition {
    fn matches(&self, percept: &Percept) -> bool {
        const ROWS_FROM: usize = RING_BITS + COLUMN_BITS;
        let column = number(percept, RING_BITS..ROWS_FROM);
        let row = number(percept, ROWS_FROM..ROWS_FROM + ROW_BITS);
        let mut bytes = percept.iter().zip(&self.bytes);
        bytes.all(|(byte, [mask, value])| byte & mask == *value)
            && (self.column[0]..=self.column[1]).contains(&column)
            && (self.row[0]..=self.row[1]).contains(&row)
    }
}
