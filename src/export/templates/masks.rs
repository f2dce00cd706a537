/// The percepts that a rule matches: for each byte a mask of the demanded bits, and their values.
struct Condition([[u8; 2]; PERCEPT_BYTES]);

impl Condition {
    fn matches(&self, percept: &Percept) -> bool {
        let mut bytes = percept.iter().zip(&self.0);
        bytes.all(|(byte, [mask, value])| byte & mask == *value)
    }
}
