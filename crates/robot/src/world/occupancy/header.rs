//! The YAML file of a map: where the image is, and what its grey levels mean.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::MapError;
use super::rules::{Mode, Rules};
use crate::input;
use crate::world::Origin;

/// The largest YAML file, in bytes. It may contain a world file, which has at most as many.
const MAX_BYTES: u64 = 64 << 20;

/// The keys of the file. Other keys are ignored. Scalars are texts, as Nav2 reads them: `"0.05"` is a number, too.
#[derive(Debug, Deserialize)]
struct Keys {
    image: Option<String>,
    resolution: Option<String>,
    origin: Option<Vec<String>>,
    negate: Option<String>,
    occupied_thresh: Option<String>,
    free_thresh: Option<String>,
    mode: Option<String>,
    xcscr: Option<String>,
}

/// A checked header.
#[derive(Debug)]
pub(super) struct Header {
    /// The path of the image.
    pub image: PathBuf,
    /// The edge of a pixel, in metres.
    pub resolution_m: f64,
    /// The pose of the lower left corner.
    pub origin: Origin,
    /// The world file of a maze that was written as a map.
    pub world: Option<String>,
    pub rules: Rules,
}

impl Header {
    /// Reads and checks a YAML file.
    pub fn load(path: &Path) -> Result<Self, MapError> {
        let text = input::read_text(path, MAX_BYTES).map_err(|cause| MapError::Unreadable {
            path: path.to_owned(),
            cause,
        })?;
        let keys = serde_saphyr::from_str(&text).map_err(|fault| fault.to_string());
        keys.and_then(|keys| Self::checked(keys, path))
            .map_err(|fault| MapError::Header {
                path: path.to_owned(),
                fault,
            })
    }

    fn checked(keys: Keys, path: &Path) -> Result<Self, String> {
        let image = given("image", keys.image)?;
        if image.is_empty() {
            return Err("`image` is empty: name the file of the image".to_owned());
        }
        let share = |key: &str, text: Option<String>| match number(key, &given(key, text)?)? {
            value if (0.0..=1.0).contains(&value) => Ok(value),
            value => Err(format!("`{key}` is {value}, but must be from 0 to 1")),
        };
        let occupied_thresh = share("occupied_thresh", keys.occupied_thresh)?;
        let free_thresh = share("free_thresh", keys.free_thresh)?;
        if free_thresh >= occupied_thresh {
            return Err(format!(
                "`free_thresh` is {free_thresh}, but must be less than `occupied_thresh`, {occupied_thresh}"
            ));
        }
        let resolution_m = number("resolution", &given("resolution", keys.resolution)?)?;
        if !(1e-3..=10.0).contains(&resolution_m) {
            return Err(format!(
                "`resolution` is {resolution_m}, but must be from 0.001 to 10 metres"
            ));
        }
        Ok(Self {
            image: path.parent().unwrap_or(Path::new("")).join(image),
            resolution_m,
            origin: origin(&given("origin", keys.origin)?)?,
            rules: Rules {
                mode: mode(keys.mode.as_deref())?,
                negate: switch("negate", &given("negate", keys.negate)?)?,
                occupied_thresh,
                free_thresh,
            },
            world: keys.xcscr,
        })
    }
}

/// Returns the value of a key that Nav2 requires.
fn given<T>(key: &str, value: Option<T>) -> Result<T, String> {
    value.ok_or_else(|| format!("`{key}` has no value, but Nav2 requires one"))
}

/// Returns the pose of the lower left corner.
fn origin(values: &[String]) -> Result<Origin, String> {
    let shape = "`origin` must be three numbers: x and y in metres, yaw in radians";
    let values: &[String; 3] = values.try_into().map_err(|_| shape.to_owned())?;
    let mut origin = [0.0; 3];
    let places = ["first", "second", "third"];
    for ((place, text), value) in places.into_iter().zip(values).zip(&mut origin) {
        *value = number("origin", text)?;
        if !value.is_finite() {
            return Err(format!(
                "the {place} value of `origin` is {value}; set it to 0"
            ));
        }
    }
    let origin = Origin::from(origin);
    let shown = <[f64; 3]>::from(origin);
    let fault = origin
        .fault()
        .map(|fault| format!("`origin` is {shown:?}: {fault}"));
    fault.map_or(Ok(origin), Err)
}

/// Returns a number, which may be one of YAML's that are not finite.
fn number(key: &str, text: &str) -> Result<f64, String> {
    let unsigned = text.trim_start_matches(['+', '-']);
    let number = match unsigned.to_ascii_lowercase().as_str() {
        ".nan" => Some(f64::NAN),
        ".inf" if text.starts_with('-') => Some(f64::NEG_INFINITY),
        ".inf" => Some(f64::INFINITY),
        // Rust also reads words such as `infinity`.
        digits if digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') => {
            text.parse().ok()
        }
        _ => None,
    };
    number.ok_or_else(|| format!("`{key}` is {text:?}, but must be a number"))
}

/// Returns true for any whole number but 0, and for the truth values of YAML 1.1.
fn switch(key: &str, text: &str) -> Result<bool, String> {
    match text.to_ascii_lowercase().as_str() {
        "y" | "yes" | "true" | "on" => Ok(true),
        "n" | "no" | "false" | "off" => Ok(false),
        digits => match digits.parse::<i64>() {
            Ok(number) => Ok(number != 0),
            Err(_) => Err(format!("`{key}` is {text:?}, but must be 0 or 1")),
        },
    }
}

/// Returns the mode of this name, in letters of any case.
fn mode(name: Option<&str>) -> Result<Mode, String> {
    match name.map(str::to_ascii_lowercase).as_deref() {
        None | Some("trinary") => Ok(Mode::Trinary),
        Some("scale") => Ok(Mode::Scale),
        Some("raw") => Ok(Mode::Raw),
        Some(other) => Err(format!(
            "`mode` is {other:?}, but must be trinary, scale or raw"
        )),
    }
}
