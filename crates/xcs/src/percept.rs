//! Binary percepts.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Machine words in a [`Percept`]; 64 bits each.
pub const PERCEPT_WORDS: usize = 5;
/// The widest percept, in bits.
pub const MAX_PERCEPT_BITS: usize = 64 * PERCEPT_WORDS;
/// A percept: a string of at most [`MAX_PERCEPT_BITS`] bits.
///
/// Bit 0 is the first character of the printed form. Bits beyond the width are zero, so that
/// equal percepts are equal word by word.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Percept {
    words: [u64; PERCEPT_WORDS],
    width: u16,
}

impl Percept {
    /// Collects bits in printing order; `None` if there are more than [`MAX_PERCEPT_BITS`].
    pub fn from_bits(bits: impl IntoIterator<Item = bool>) -> Option<Self> {
        let mut words = [0; PERCEPT_WORDS];
        let mut width = 0;
        for bit in bits {
            *words.get_mut(width / 64)? |= u64::from(bit) << (width % 64);
            width += 1;
        }
        Some(Self {
            words,
            width: width as u16,
        })
    }

    /// Creates a percept of the lowest `width` bits (at most 64) of a machine word, the lowest
    /// first.
    pub fn from_word(word: u64, width: usize) -> Self {
        let width = width.min(64);
        let mask = u64::MAX.checked_shr(64 - width as u32).unwrap_or(0);
        Self {
            words: std::array::from_fn(|at| if at == 0 { word & mask } else { 0 }),
            width: width as u16,
        }
    }

    /// Returns the number of bits.
    pub fn width(&self) -> usize {
        usize::from(self.width)
    }

    /// Returns bit `index`, counted from the first printed character; `false` beyond the width.
    pub fn bit(&self, index: usize) -> bool {
        self.words
            .get(index / 64)
            .is_some_and(|word| word >> (index % 64) & 1 == 1)
    }

    /// Returns the concatenation of both percepts, truncated to [`MAX_PERCEPT_BITS`].
    pub fn followed_by(&self, other: &Self) -> Self {
        let (skipped, shift) = (self.width() / 64, self.width() as u32 % 64);
        let mut words = self.words;
        for (at, word) in other.words.iter().enumerate() {
            if let Some(low) = words.get_mut(at + skipped) {
                *low |= word << shift;
            }
            if let Some(high) = words.get_mut(at + skipped + 1) {
                *high |= word.checked_shr(64 - shift).unwrap_or(0);
            }
        }
        let width = (self.width() + other.width()).min(MAX_PERCEPT_BITS);
        Self {
            words,
            width: width as u16,
        }
    }

    /// Returns the percept with its first `ring` bits rotated by `by` positions: bit `by` becomes
    /// the first.
    pub fn rotated(&self, by: usize, ring: usize) -> Self {
        let source = |at| if at < ring { (at + by) % ring } else { at };
        let bits = (0..self.width()).map(|at| self.bit(source(at)));
        Self::from_bits(bits).expect("as many bits as before")
    }

    /// Returns the bits as machine words, bit 0 lowest.
    pub fn words(&self) -> &[u64; PERCEPT_WORDS] {
        &self.words
    }
}

impl fmt::Display for Percept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (0..self.width()).try_for_each(|i| f.write_str(if self.bit(i) { "1" } else { "0" }))
    }
}

impl fmt::Debug for Percept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Percept({self})")
    }
}

/// A text that is not a valid percept.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a percept: expected at most {MAX_PERCEPT_BITS} characters, each 0 or 1")]
pub struct PerceptError(String);

impl FromStr for Percept {
    type Err = PerceptError;

    fn from_str(text: &str) -> Result<Self, PerceptError> {
        let error = || PerceptError(text.chars().take(MAX_PERCEPT_BITS + 1).collect());
        if text.bytes().any(|b| !matches!(b, b'0' | b'1')) {
            return Err(error());
        }
        Self::from_bits(text.bytes().map(|b| b == b'1')).ok_or_else(error)
    }
}

impl TryFrom<String> for Percept {
    type Error = PerceptError;

    fn try_from(text: String) -> Result<Self, PerceptError> {
        text.parse()
    }
}

impl From<Percept> for String {
    fn from(percept: Percept) -> Self {
        percept.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percept_prints_as_it_was_read() {
        let text = "0110100110010110".repeat(16);
        assert_eq!(text.parse::<Percept>().unwrap().to_string(), text);
    }

    #[test]
    fn a_word_gives_its_lowest_bits() {
        let of = |width| Percept::from_word(0b1101, width).to_string();
        assert_eq!([0, 3, 5].map(of), ["", "101", "10110"]);
        assert_eq!(Percept::from_word(u64::MAX, 64).to_string(), "1".repeat(64));
    }

    #[test]
    fn a_percept_wider_than_the_bound_is_refused_and_the_message_names_it() {
        assert!("0".repeat(MAX_PERCEPT_BITS).parse::<Percept>().is_ok());
        let error = "0".repeat(MAX_PERCEPT_BITS + 1).parse::<Percept>();
        let message = error.unwrap_err().to_string();
        assert!(
            message.contains(&format!("at most {MAX_PERCEPT_BITS} characters")),
            "{message}"
        );
    }

    #[test]
    fn one_percept_follows_another_bit_by_bit_and_what_does_not_fit_is_lost() {
        let text = "0110100110010111".repeat(MAX_PERCEPT_BITS / 16);
        for (first, second) in [
            (0, 9),
            (9, 0),
            (16, 64),
            (64, 64),
            (65, 130),
            (200, 100),
            (MAX_PERCEPT_BITS - 56, 100),
            (MAX_PERCEPT_BITS, 3),
        ] {
            let [a, b] = [&text[..first], &text[text.len() - second..]];
            let [one, two]: [Percept; 2] = [a, b].map(|bits| bits.parse().unwrap());
            let both = format!("{a}{b}");
            let expected = &both[..both.len().min(MAX_PERCEPT_BITS)];
            assert_eq!(
                one.followed_by(&two),
                expected.parse().unwrap(),
                "{first}, {second}"
            );
        }
    }

    #[test]
    fn turning_moves_the_bits_of_the_ring_and_no_others() {
        let percept: Percept = "001011".parse().unwrap();
        assert_eq!(percept.rotated(2, 4).to_string(), "100011");
        assert_eq!(percept.rotated(3, 0), percept);
    }

    #[test]
    fn other_characters_are_refused() {
        assert!("01#1".parse::<Percept>().is_err());
    }
}
