//! Solid geometry: the true shape of the walls, as a raster.
//!
//! Physics, lidar, and every test of whether the robot fits use [`Solid`]. In a maze the pixels are
//! the cells. In a world from a map they are the pixels of the map, and the cells only divide the
//! free space. Lengths are in metres of the grid frame.

mod blocks;
mod clear;
mod distance;
mod file;
mod surface;
mod way;

use std::sync::{Arc, OnceLock};

use nalgebra::{Isometry2, Point2, Vector2};

pub use blocks::Block;
pub(super) use file::Keys;
pub use way::Narrowest;

use super::Origin;

/// Solid and free pixels. Everything outside the raster is solid. A clone shares the pixels.
#[derive(Debug, Clone)]
pub struct Solid {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Row by row from the top: true for solid pixels.
    pub(super) bits: Arc<[bool]>,
    pub(super) pixel_m: f64,
    /// The pose of the lower left corner in the grid frame.
    pub(super) corner: Origin,
    /// The same; `None` if it is the grid frame.
    corner_in_grid: Option<Isometry2<f64>>,
    /// The radius in metres of the disc that stays clear on every move between cells; 0 in a maze.
    pub(super) radius_m: f64,
    /// Row by row from the top: the squared distance to the nearest solid pixel, between middles,
    /// in pixels.
    squares: OnceLock<Arc<[u32]>>,
}

impl PartialEq for Solid {
    fn eq(&self, other: &Self) -> bool {
        let place = |one: &Self| (one.width, one.pixel_m, one.corner, one.radius_m);
        place(self) == place(other) && self.bits == other.bits
    }
}

impl Solid {
    /// Creates the geometry of pixels with an edge of `pixel_m`, row by row from the top, in
    /// `width` columns. `corner` is the pose of the lower left corner in the grid frame.
    pub(super) fn new(width: usize, bits: Arc<[bool]>, pixel_m: f64, corner: Origin) -> Self {
        Self {
            width,
            height: bits.len() / width.max(1),
            bits,
            pixel_m,
            corner,
            corner_in_grid: (corner != Origin::default()).then(|| corner.pose()),
            radius_m: 0.0,
            squares: OnceLock::new(),
        }
    }

    /// Returns the same geometry with other pixels, row by row from the top.
    pub(super) fn with_bits(&self, bits: Arc<[bool]>) -> Self {
        Self {
            radius_m: self.radius_m,
            ..Self::new(self.width, bits, self.pixel_m, self.corner)
        }
    }

    /// Returns the same geometry with a square box, whose sides are parallel to those of the
    /// pixels. A pixel becomes solid if its middle is in the box.
    pub(super) fn with_box(&self, middle_m: Point2<f64>, side_m: f64) -> Self {
        let middle = self.in_raster(middle_m);
        let mut bits = self.bits.to_vec();
        for (at, bit) in bits.iter_mut().enumerate() {
            let [col, up] = [at % self.width, self.height - 1 - at / self.width];
            let pixel = [col, up].map(|number| (number as f64 + 0.5) * self.pixel_m);
            let reach = (Point2::from(pixel) - middle).amax();
            *bit |= reach <= side_m / 2.0;
        }
        self.with_bits(bits.into())
    }

    /// Returns the number of columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Returns the edge of a pixel in metres.
    pub fn pixel_m(&self) -> f64 {
        self.pixel_m
    }

    /// Returns the pose of the lower left corner in the grid frame; `None` if it is the grid frame.
    pub fn corner_in_grid(&self) -> Option<&Isometry2<f64>> {
        self.corner_in_grid.as_ref()
    }

    /// Returns true if a pixel is solid; columns count to the right and rows upward. Pixels outside
    /// the raster are solid.
    pub fn is_solid(&self, col: i32, row: i32) -> bool {
        // Negative numbers become large ones.
        let (col, up) = (col as usize, row as usize);
        col >= self.width || up >= self.height || {
            let below = (self.height - 1 - up) * self.width;
            self.bits[below + col]
        }
    }

    /// Returns true if a point of the grid frame is in a solid pixel.
    #[cfg(test)]
    pub(crate) fn is_solid_at(&self, point_m: Point2<f64>) -> bool {
        let [col, row] = self.pixel_of(self.in_raster(point_m));
        self.is_solid(col, row)
    }

    /// Returns true if `test` accepts every solid pixel that is nearer than `reach_m` to a point of
    /// the grid frame. `test` gets the vector from the nearest point of the pixel to the point.
    pub fn all_near(
        &self,
        point_m: Point2<f64>,
        reach_m: f64,
        mut test: impl FnMut(Vector2<f64>) -> bool,
    ) -> bool {
        let at = self.in_raster(point_m);
        if self.is_clearly_free(at, reach_m) {
            return true;
        }
        let turn = self.corner_in_grid().map(|corner| corner.rotation);
        let reach = Vector2::repeat(reach_m);
        let [[west, south], [east, north]] = [at - reach, at + reach].map(|at| self.pixel_of(at));
        (south..=north).all(|row| {
            (west..=east).all(|col| {
                if !self.is_solid(col, row) {
                    return true;
                }
                let from_wall = self.offset_from_pixel(at, col, row);
                let is_near = from_wall.norm_squared() < reach_m * reach_m;
                !is_near || test(turn.map_or(from_wall, |turn| turn * from_wall))
            })
        })
    }

    /// Returns the vector from the nearest point of a pixel to a point of the raster.
    fn offset_from_pixel(&self, at: Point2<f64>, col: i32, row: i32) -> Vector2<f64> {
        let beyond = |at: f64, number: i32| {
            let low = f64::from(number) * self.pixel_m;
            let high = (f64::from(number) + 1.0) * self.pixel_m;
            at - at.clamp(low, high)
        };
        Vector2::new(beyond(at.x, col), beyond(at.y, row))
    }

    /// Returns true if the distances between pixels alone show that no solid pixel is nearer than
    /// `reach_m`. They cannot where the pixels are as large as the reach.
    fn is_clearly_free(&self, at: Point2<f64>, reach_m: f64) -> bool {
        let [col, row] = self.pixel_of(at);
        self.pixel_m < reach_m && self.clear_m(col, row) > reach_m
    }

    /// Returns a length in metres below which nothing is solid around any point of a pixel. It is
    /// negative near solid pixels.
    pub fn clear_m(&self, col: i32, row: i32) -> f64 {
        // Both points may be half a diagonal away from the middles of their pixels.
        (self.pixels_to_solid(col, row) - std::f64::consts::SQRT_2) * self.pixel_m
    }

    /// Returns the distance between the middles of a pixel and of the nearest solid one, in pixels.
    fn pixels_to_solid(&self, col: i32, row: i32) -> f64 {
        f64::from(self.squares_to_solid([col, row])).sqrt()
    }

    /// Returns the square of this distance.
    fn squares_to_solid(&self, [col, row]: [i32; 2]) -> u32 {
        if self.is_solid(col, row) {
            return 0;
        }
        let squares = self
            .squares
            .get_or_init(|| distance::squares(self.width, &self.bits).into());
        squares[(self.height - 1 - row as usize) * self.width + col as usize]
    }

    /// Returns the column and row of the pixel that contains a point of the raster, or would.
    fn pixel_of(&self, at: Point2<f64>) -> [i32; 2] {
        [at.x, at.y].map(|at| (at / self.pixel_m).floor() as i32)
    }

    /// Converts a point from the grid frame to that of the lower left corner.
    fn in_raster(&self, point_m: Point2<f64>) -> Point2<f64> {
        let corner = self.corner_in_grid();
        corner.map_or(point_m, |corner| corner.inverse_transform_point(&point_m))
    }

    /// Converts a point from the frame of the lower left corner to the grid frame.
    pub fn in_grid(&self, at: Point2<f64>) -> Point2<f64> {
        let corner = self.corner_in_grid();
        corner.map_or(at, |corner| corner * at)
    }
}
