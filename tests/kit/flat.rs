//! A small flat as a ROS map: no wall is on a line of any grid.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use tempfile::TempDir;
use xcscr::world::{Gridded, Gridding, OccupancyMap};

use super::folder::replace;

/// The edge of a pixel in metres.
pub const PIXEL_M: f64 = 0.05;
/// The number of columns and rows.
pub const SIZE: [usize; 2] = [160, 120];
/// The angle between the walls and the image, in radians.
pub const TILT_RAD: f64 = 0.13;

/// The map of the flat, in a folder of its own.
pub struct Flat(TempDir);

/// Returns true if something is at a point of the map, in metres from the lower left corner.
fn is_built(x: f64, y: f64) -> bool {
    let (sine, cosine) = TILT_RAD.sin_cos();
    let (x, y) = (x - 4.0, y - 3.0);
    let (x, y) = (cosine * x + sine * y, cosine * y - sine * x);
    let outside = x.abs() > 3.13 || y.abs() > 2.07;
    let wall = (0.21..0.31).contains(&x) && !(-0.4..0.75).contains(&y);
    let pillar = (x + 1.83).hypot(y - 0.17) < 0.22;
    let slanted = x + y > 4.4;
    let legs = [[1.6, -0.5], [2.37, -0.5], [1.6, 0.1], [2.37, 0.1]];
    let leg = legs
        .iter()
        .any(|leg| (x - leg[0]).hypot(y - leg[1]) < 0.045);
    outside || wall || pillar || slanted || leg
}

/// Returns true if the pixel at a point of the map is solid.
pub fn is_solid(x: f64, y: f64) -> bool {
    static PIXELS: OnceLock<Vec<bool>> = OnceLock::new();
    let [width, height] = SIZE;
    let pixels = PIXELS.get_or_init(|| {
        let middle = |number: usize| (number as f64 + 0.5) * PIXEL_M;
        let pixels = (0..width * height).map(|at| (middle(at % width), middle(at / width)));
        pixels.map(|(x, y)| is_built(x, y)).collect()
    });
    let [col, row] = [x, y].map(|at| (at / PIXEL_M).floor() as usize);
    col >= width || row >= height || pixels[row * width + col]
}

impl Flat {
    /// Draws the map.
    pub fn new() -> Self {
        let [width, height] = SIZE;
        let mut pgm = format!("P5 {width} {height} 255\n").into_bytes();
        for row in 0..height {
            let y = (height - row) as f64 - 0.5;
            let xs = (0..width).map(|col| col as f64 + 0.5);
            pgm.extend(xs.map(|x| match is_built(x * PIXEL_M, y * PIXEL_M) {
                true => 0,
                false => 254,
            }));
        }
        let yaml = format!(
            "image: flat.pgm\nresolution: {PIXEL_M}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        );
        let folder = tempfile::tempdir().unwrap();
        replace(&folder.path().join("flat.pgm"), &pgm);
        replace(&folder.path().join("flat.yaml"), yaml.as_bytes());
        Self(folder)
    }

    /// Returns the folder of the map.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// Returns the YAML file.
    pub fn yaml(&self) -> PathBuf {
        self.0.path().join("flat.yaml")
    }

    /// Converts the map to a world with cells of this size, from the left room to the right one.
    pub fn gridded(&self, cell_m: f64) -> Gridded {
        self.turned(cell_m, 0.0)
    }

    /// Converts the map with a grid that is turned against the image.
    pub fn turned(&self, cell_m: f64, yaw_rad: f64) -> Gridded {
        let gridding = Gridding {
            cell_m: Some(cell_m),
            start_m: Some([1.6, 1.7]),
            goal_m: Some([6.3, 4.2]),
            unknown_is_free: false,
            yaw_rad,
            despeckle: 0,
            offset_m: None,
            name: "flat".to_owned(),
        };
        gridding
            .of(&OccupancyMap::load(&self.yaml()).unwrap())
            .unwrap()
    }
}
