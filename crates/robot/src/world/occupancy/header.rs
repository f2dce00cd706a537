//! The YAML file of a map: where the image is, and what its grey levels mean.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::MapError;
use super::rules::{Mode, Rules};
use crate::input;
use crate::world::Origin;

/// The largest YAML file, in bytes. It may contain a world file, which has at most as many.
const MAX_BYTES: u64 = 64 << 20;

/// A number or a boolean: `negate` may be either.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Switch {
    Bool(bool),
    Number(i64),
}

/// The keys of the file. Other keys are ignored.
#[derive(Debug, Deserialize)]
struct Keys {
    image: PathBuf,
    resolution: f64,
    origin: Vec<f64>,
    negate: Switch,
    occupied_thresh: f64,
    free_thresh: f64,
    #[serde(default)]
    mode: Mode,
    #[serde(default)]
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
        let origin = <[f64; 3]>::try_from(keys.origin)
            .map_err(|_| "`origin` must be three numbers: x and y in metres, yaw in radians")?;
        let origin = Origin::from(origin);
        if let Some(fault) = origin.fault() {
            return Err(format!(
                "`origin` is {:?}: {fault}",
                <[f64; 3]>::from(origin)
            ));
        }
        let share = |key: &str, value: f64| match (0.0..=1.0).contains(&value) {
            true => Ok(value),
            false => Err(format!("`{key}` is {value}, but must be from 0 to 1")),
        };
        let occupied_thresh = share("occupied_thresh", keys.occupied_thresh)?;
        let free_thresh = share("free_thresh", keys.free_thresh)?;
        if free_thresh >= occupied_thresh {
            return Err(format!(
                "`free_thresh` is {free_thresh}, but must be less than `occupied_thresh`, {occupied_thresh}"
            ));
        }
        if !(1e-3..=10.0).contains(&keys.resolution) {
            let found = keys.resolution;
            return Err(format!(
                "`resolution` is {found}, but must be from 0.001 to 10 metres"
            ));
        }
        Ok(Self {
            image: path.parent().unwrap_or(Path::new("")).join(keys.image),
            resolution_m: keys.resolution,
            origin,
            rules: Rules {
                mode: keys.mode,
                negate: matches!(keys.negate, Switch::Bool(true) | Switch::Number(1..)),
                occupied_thresh,
                free_thresh,
            },
            world: keys.xcscr,
        })
    }
}
