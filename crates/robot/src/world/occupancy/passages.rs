//! Finds the passages that are too narrow for a cell.

use std::collections::{BTreeMap, VecDeque};

use super::cells::Cells;
use super::passage::Passage;

/// No area: a wall, or an unreachable pixel.
const NOWHERE: u32 = u32::MAX;

/// The areas of connected free cells, and the passages between them.
pub(super) struct Passages {
    /// The area of each cell.
    area: Vec<u32>,
    /// For each area: the widest passage to each neighbouring area.
    beside: Vec<BTreeMap<u32, Passage>>,
}

impl Passages {
    /// Grows all areas over the free pixels around them, until they meet.
    pub fn find(cells: &Cells<'_>) -> Self {
        let (area, count) = areas(cells);
        let mut growth = Growth::new(cells, &area);
        let mut found = Self {
            area,
            beside: vec![BTreeMap::new(); count],
        };
        while let Some(pixel) = growth.next.pop_front() {
            for other in growth.beside(pixel as usize) {
                if let Some((areas, passage)) = growth.step(pixel as usize, other) {
                    found.meet(areas, passage);
                }
            }
        }
        found
    }

    /// Records that two areas meet, and keeps the widest passage between them.
    fn meet(&mut self, [a, b]: [u32; 2], passage: Passage) {
        for (from, to) in [(a, b), (b, a)] {
            let widest = self.beside[from as usize].entry(to).or_insert(passage);
            if passage.width_m > widest.width_m {
                *widest = passage;
            }
        }
    }

    /// Returns the passages on the path with the fewest passages. Without a start, those next to
    /// the goal's area.
    pub fn between(&self, start: Option<usize>, goal: usize) -> Vec<Passage> {
        let Some(start) = start else {
            return self.from(goal);
        };
        let (from, to) = (self.area[start], self.area[goal]);
        let mut before: BTreeMap<u32, (u32, Passage)> = BTreeMap::new();
        let mut next = VecDeque::from([to]);
        while let Some(area) = next.pop_front() {
            for (&other, &passage) in &self.beside[area as usize] {
                if other != to && !before.contains_key(&other) {
                    before.insert(other, (area, passage));
                    next.push_back(other);
                }
            }
        }
        let step = |&area: &u32| before.get(&area).map(|&(next, _)| next);
        let path = std::iter::successors(Some(from), step);
        path.filter_map(|area| before.get(&area).map(|&(_, passage)| passage))
            .collect()
    }

    /// Returns the passages out of the area of a free cell.
    pub fn from(&self, cell: usize) -> Vec<Passage> {
        let beside = &self.beside[self.area[cell] as usize];
        beside.values().copied().collect()
    }
}

/// Areas that grow over free pixels.
struct Growth<'a> {
    cells: &'a Cells<'a>,
    /// The area of each pixel.
    owner: Vec<u32>,
    /// For each pixel: the narrowest pixel on the path along which its area grew.
    narrowest: Vec<u32>,
    widths: Vec<f32>,
    /// The pixels from which an area may still grow.
    next: VecDeque<u32>,
}

impl<'a> Growth<'a> {
    fn new(cells: &'a Cells<'a>, area: &[u32]) -> Self {
        let (width, height) = (cells.raster.map.width, cells.raster.map.height);
        let mut growth = Self {
            cells,
            owner: vec![NOWHERE; width * height],
            narrowest: (0..).take(width * height).collect(),
            widths: widths_px(cells),
            next: VecDeque::new(),
        };
        for (at, &area) in area.iter().enumerate().filter(|(_, a)| **a != NOWHERE) {
            let (cols, rows) = cells.pixels(at);
            for row in rows {
                growth.owner[row * width..][cols.clone()].fill(area);
            }
        }
        // An area grows only at its edge.
        for pixel in (0..width * height).filter(|&pixel| growth.owner[pixel] != NOWHERE) {
            let owner = growth.owner[pixel];
            if growth
                .beside(pixel)
                .any(|other| growth.owner[other] != owner)
            {
                growth.next.push_back(pixel as u32);
            }
        }
        growth
    }

    /// Returns the neighbours of a pixel.
    fn beside(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.cells.raster.map.width, self.cells.raster.map.height);
        let (col, row) = (pixel % width, pixel / width);
        let beside = [
            (col > 0).then(|| pixel - 1),
            (col + 1 < width).then_some(pixel + 1),
            (row > 0).then(|| pixel - width),
            (row + 1 < height).then_some(pixel + width),
        ];
        beside.into_iter().flatten()
    }

    /// Grows from a pixel to its neighbour. If the neighbour belongs to another area, returns the
    /// two areas and the passage between them.
    fn step(&mut self, pixel: usize, other: usize) -> Option<([u32; 2], Passage)> {
        let width = self.cells.raster.map.width;
        if self.owner[other] == NOWHERE {
            if self.cells.raster.is_free(other % width, other / width) {
                self.owner[other] = self.owner[pixel];
                self.narrowest[other] = self.narrower(other as u32, self.narrowest[pixel]);
                self.next.push_back(other as u32);
            }
            return None;
        }
        let areas = [self.owner[pixel], self.owner[other]];
        let least = self.narrower(self.narrowest[pixel], self.narrowest[other]) as usize;
        (areas[0] != areas[1]).then(|| {
            let passage = Passage {
                at_m: self.cells.raster.map.in_map_m(least % width, least / width),
                width_m: f64::from(self.widths[least]) * self.cells.raster.map.resolution_m,
            };
            (areas, passage)
        })
    }

    /// Returns the narrower of two pixels; the first if they are equal.
    fn narrower(&self, pixel: u32, other: u32) -> u32 {
        let width = |pixel: u32| self.widths[pixel as usize];
        if width(pixel) <= width(other) {
            pixel
        } else {
            other
        }
    }
}

/// Returns the area of connected free cells of each cell, and the number of areas.
fn areas(cells: &Cells<'_>) -> (Vec<u32>, usize) {
    let mut area = vec![NOWHERE; cells.free.len()];
    let mut count = 0;
    for first in 0..area.len() {
        if !cells.free[first] || area[first] != NOWHERE {
            continue;
        }
        area[first] = count;
        let mut next = vec![first];
        while let Some(at) = next.pop() {
            for other in cells.neighbours(at) {
                if area[other] == NOWHERE {
                    area[other] = count;
                    next.push(other);
                }
            }
        }
        count += 1;
    }
    (area, count as usize)
}

/// Returns, for each pixel, the length of the shortest run of free pixels through it, over the four
/// directions. Each line of the image is scanned once.
fn widths_px(cells: &Cells<'_>) -> Vec<f32> {
    let (width, height) = (cells.raster.map.width, cells.raster.map.height);
    let mut widths = vec![f32::INFINITY; width * height];
    let (left, right) = (
        (0..height).map(|row| (0, row)),
        (0..height).map(|row| (width - 1, row)),
    );
    let top = |from: usize, to: usize| (from..to).map(|col| (col, 0));
    let diagonal = std::f32::consts::SQRT_2;
    let mut walk = |first: (usize, usize), step: (isize, isize), pixel: f32| {
        shorten(cells, &mut widths, first, step, pixel);
    };
    left.clone().for_each(|first| walk(first, (1, 0), 1.0));
    top(0, width).for_each(|first| walk(first, (0, 1), 1.0));
    left.chain(top(1, width))
        .for_each(|first| walk(first, (1, 1), diagonal));
    right
        .chain(top(0, width - 1))
        .for_each(|first| walk(first, (-1, 1), diagonal));
    widths
}

/// Limits the widths of the pixels on a line to the lengths of their runs of free pixels.
fn shorten(
    cells: &Cells<'_>,
    widths: &mut [f32],
    first: (usize, usize),
    (dx, dy): (isize, isize),
    pixel: f32,
) {
    let (width, height) = (cells.raster.map.width, cells.raster.map.height);
    let next = |&(col, row): &(usize, usize)| {
        let next = (col.checked_add_signed(dx)?, row.checked_add_signed(dy)?);
        (next.0 < width && next.1 < height).then_some(next)
    };
    let mut run = Vec::new();
    let mut end = |run: &mut Vec<usize>| {
        let length = run.len() as f32 * pixel;
        run.drain(..)
            .for_each(|at| widths[at] = widths[at].min(length));
    };
    for (col, row) in std::iter::successors(Some(first), next) {
        match cells.raster.is_free(col, row) {
            true => run.push(row * width + col),
            false => end(&mut run),
        }
    }
    end(&mut run);
}
