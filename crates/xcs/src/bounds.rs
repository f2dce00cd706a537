//! Declarations of settings: name, default, range and description, each stated once.
//!
//! The macro [`settings!`](crate::settings) generates the struct, its defaults, its range check and
//! the list that the documentation is generated from.

use std::fmt;
use std::ops::RangeInclusive;

/// The declaration of a setting.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    /// Its full name, such as `xcs.beta`.
    pub key: &'static str,
    /// The description: meaning, unit, source, and the problems at the extremes.
    pub about: &'static str,
    /// The allowed range in words; `None` for switches and names.
    pub range: Option<String>,
}

/// A setting whose value is out of range.
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

/// Checks that `value` is in `range`; NaN never is.
///
/// # Errors
/// Returns [`OutOfRange`] with the key, the value and the range.
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
        allowed: in_words(&range),
    })
}

/// Returns a range in the form used in messages.
pub fn in_words<T: fmt::Display>(range: &RangeInclusive<T>) -> String {
    format!("from {} to {}", range.start(), range.end())
}

/// Declares settings. Generates the struct, its defaults, `check`, which checks the range of each
/// setting, and `declared`, which lists the settings.
///
/// ```
/// xcs::settings! {
///     section "kettle";
///
///     /// How a kettle works.
///     pub struct Kettle {
///         /// The temperature at which it stops, in degrees Celsius.
///         limit_c: f64 = 100.0, in 40.0..=100.0;
///         /// Whether it whistles.
///         whistles: bool = true;
///     }
/// }
///
/// let hot = Kettle { limit_c: 120.0, ..Kettle::default() };
/// let fault = hot.check().unwrap_err().to_string();
/// assert_eq!(fault, "`kettle.limit_c` is 120, but must be from 40 to 100");
/// assert_eq!(Kettle::declared()[1].key, "kettle.whistles");
/// ```
///
/// `also name;` after the section names a method `fn(&self) -> Result<(), OutOfRange>` for checks
/// that ranges cannot express. `constants { name: type = value; }` after the struct adds fields that are no settings:
/// no file can set them, and tests vary them as a control. The declaring crate needs `serde` with its derive macros.
#[macro_export]
macro_rules! settings {
    (
        section $section:literal;
        $(also $also:ident;)?

        $(#[doc = $about:literal])*
        pub struct $name:ident {
            $(
                $(#[doc = $doc:literal])*
                $(#[serde($($serde:tt)*)])?
                $field:ident: $type:ty = $default:expr $(, in $range:expr)?;
            )*
        }
        $(constants {
            $(
                $(#[doc = $constant_doc:literal])*
                $constant:ident: $constant_type:ty = $value:expr;
            )*
        })?
    ) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $(
                $(#[doc = $doc])*
                #[doc = concat!("\n\nDefault: `", stringify!($default), "`", $("; range: `", stringify!($range), "`",)? ".")]
                $(#[serde($($serde)*)])?
                pub $field: $type,
            )*
            $($(
                $(#[doc = $constant_doc])*
                #[doc = concat!("\n\nA constant: `", stringify!($value), "`. Only tests vary it.")]
                #[serde(skip)]
                pub $constant: $constant_type,
            )*)?
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* $($($constant: $value,)*)? }
            }
        }

        impl $name {
            /// Checks that each setting is within its range.
            ///
            /// # Errors
            /// Returns the first setting out of its range, with the range.
            pub fn check(&self) -> Result<(), $crate::bounds::OutOfRange> {
                $($(
                    let key = concat!($section, ".", stringify!($field));
                    $crate::bounds::within(key, self.$field, $range)?;
                )?)*
                $(self.$also()?;)?
                Ok(())
            }

            /// Returns the declaration of each setting.
            pub fn declared() -> Vec<$crate::bounds::Setting> {
                vec![$(
                    $crate::bounds::Setting {
                        key: concat!($section, ".", stringify!($field)),
                        about: concat!($($doc, "\n"),*).trim(),
                        range: [$($crate::bounds::in_words::<$type>(&($range)))?].into_iter().next(),
                    },
                )*]
            }
        }
    };
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
    fn nan_is_in_no_range() {
        assert!(within("x", f64::NAN, f64::MIN..=f64::MAX).is_err());
        assert!(within("x", f64::INFINITY, 0.0..=1e9).is_err());
    }
}
