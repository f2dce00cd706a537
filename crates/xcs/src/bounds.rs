//! Ranges of settings, checked in one place with one message.

use std::fmt;
use std::ops::RangeInclusive;

/// A setting whose value lies outside its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{key}` is {value}, but must be {allowed}")]
pub struct OutOfRange {
    /// The setting's full name, such as `xcs.beta`.
    pub key: &'static str,
    /// The value that was given.
    pub value: String,
    /// The allowed range in words.
    pub allowed: String,
}

/// Accepts `value` when it lies in `range`; NaN never does.
pub fn within<T: PartialOrd + fmt::Display>(
    key: &'static str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<(), OutOfRange> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(OutOfRange {
        key,
        value: value.to_string(),
        allowed: format!("from {} to {}", range.start(), range.end()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_key_value_and_range() {
        let error = within("xcs.beta", 2.5, 0.0..=1.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`xcs.beta` is 2.5, but must be from 0 to 1"
        );
    }

    #[test]
    fn not_a_number_lies_in_no_range() {
        assert!(within("x", f64::NAN, f64::MIN..=f64::MAX).is_err());
        assert!(within("x", f64::INFINITY, 0.0..=1e9).is_err());
    }
}
