//! The `Range` header of HTTP.

use std::ops::Range;

/// The bytes of a file that a request asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Wanted {
    /// The whole file; also for invalid headers and several ranges.
    All,
    /// A non-empty range of bytes.
    Part(Range<u64>),
    /// Bytes outside the file.
    Nothing,
}

impl Wanted {
    /// Parses a header such as `bytes=0-99`, `bytes=100-` or `bytes=-8`.
    pub fn of(header: Option<&str>, size: u64) -> Self {
        let range = header.and_then(|text| text.trim().strip_prefix("bytes="));
        let Some((first, last)) = range.and_then(|range| range.split_once('-')) else {
            return Self::All;
        };
        let number = |text: &str| text.trim().parse::<u64>();
        let part = match (number(first), number(last)) {
            (Ok(first), Ok(last)) if first > last => return Self::All,
            (Ok(first), Ok(last)) => first..size.min(last.saturating_add(1)),
            (Ok(first), Err(_)) if last.trim().is_empty() => first..size,
            (Err(_), Ok(length)) if first.trim().is_empty() => size.saturating_sub(length)..size,
            _ => return Self::All,
        };
        if part.is_empty() {
            Self::Nothing
        } else {
            Self::Part(part)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_cut_to_the_file() {
        let of = |text| Wanted::of(Some(text), 10);
        assert_eq!(of("bytes=0-3"), Wanted::Part(0..4));
        assert_eq!(of("bytes=4-"), Wanted::Part(4..10));
        assert_eq!(of("bytes=-3"), Wanted::Part(7..10));
        assert_eq!(of("bytes=-30"), Wanted::Part(0..10));
        assert_eq!(of("bytes=8-99"), Wanted::Part(8..10));
        assert_eq!(of("bytes=0-18446744073709551615"), Wanted::Part(0..10));
    }

    #[test]
    fn a_range_beyond_the_end_is_empty() {
        for text in ["bytes=10-", "bytes=10-12", "bytes=-0"] {
            assert_eq!(Wanted::of(Some(text), 10), Wanted::Nothing, "{text}");
        }
        assert_eq!(Wanted::of(Some("bytes=-5"), 0), Wanted::Nothing);
    }

    #[test]
    fn invalid_headers_ask_for_the_whole_file() {
        for text in [
            "",
            "bytes",
            "bytes=",
            "bytes=3-1",
            "bytes=0-1,3-4",
            "lines=0-1",
            "bytes=a-b",
        ] {
            assert_eq!(Wanted::of(Some(text), 10), Wanted::All, "{text}");
        }
        assert_eq!(Wanted::of(None, 10), Wanted::All);
    }
}
