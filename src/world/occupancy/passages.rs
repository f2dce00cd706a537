//! Finding the passages in which no cell fits.

use std::collections::{BTreeMap, VecDeque};

use super::cells::Cells;
use super::passage::Passage;

/// No area: a wall, or a pixel that no way leads to.
const NOWHERE: u32 = u32::MAX;

/// The areas that free cells form, and the passages between them.
#[derive(Default)]
pub(super) struct Passages {
    /// By cell: the area that it belongs to.
    area: Vec<u32>,
    /// By pair of areas, the lower number first: the widest passage.
    between: BTreeMap<(u32, u32), Passage>,
}

impl Passages {
    /// Grows all areas over the free pixels around them, until they meet.
    pub fn find(cells: &Cells<'_>) -> Self {
        let mut found = Self {
            area: areas(cells),
            between: BTreeMap::new(),
        };
        let (width, height) = (cells.map.width, cells.map.height);
        let mut owner = vec![NOWHERE; width * height];
        // By pixel: the one from which its area grew there, so far from the cells.
        let mut before: Vec<u32> = (0..).take(width * height).collect();
        let mut next = VecDeque::new();
        for (at, &area) in found
            .area
            .iter()
            .enumerate()
            .filter(|(_, area)| **area != NOWHERE)
        {
            let (cols, rows) = cells.pixels(at);
            for pixel in rows.flat_map(|row| cols.clone().map(move |col| row * width + col)) {
                owner[pixel] = area;
                next.push_back(pixel);
            }
        }
        while let Some(pixel) = next.pop_front() {
            let (col, row) = (pixel % width, pixel / width);
            let beside = [
                (col > 0).then(|| pixel - 1),
                (col + 1 < width).then_some(pixel + 1),
                (row > 0).then(|| pixel - width),
                (row + 1 < height).then_some(pixel + width),
            ];
            for other in beside.into_iter().flatten() {
                if owner[other] == NOWHERE && cells.is_free_pixel(other % width, other / width) {
                    owner[other] = owner[pixel];
                    before[other] = pixel as u32;
                    next.push_back(other);
                } else if owner[other] != NOWHERE && owner[other] != owner[pixel] {
                    let areas = [owner[pixel], owner[other]];
                    let way = way(&before, pixel).chain(way(&before, other));
                    found.meet(areas, narrowest(cells, way));
                }
            }
        }
        found
    }

    /// Notes that two areas meet, and keeps the widest passage between them.
    fn meet(&mut self, [a, b]: [u32; 2], passage: Passage) {
        let widest = self.between.entry((a.min(b), a.max(b))).or_insert(passage);
        if passage.width_m > widest.width_m {
            *widest = passage;
        }
    }

    /// The passages on the way with the fewest of them; without a start, those beside the goal.
    pub fn between(&self, start: Option<usize>, goal: usize) -> Vec<Passage> {
        let Some(start) = start else {
            return self.from(goal);
        };
        let (from, to) = (self.area[start], self.area[goal]);
        let mut before: BTreeMap<u32, (u32, Passage)> = BTreeMap::new();
        let mut next = VecDeque::from([to]);
        while let Some(area) = next.pop_front() {
            for (other, passage) in self.beside(area) {
                if other != to && !before.contains_key(&other) {
                    before.insert(other, (area, passage));
                    next.push_back(other);
                }
            }
        }
        let step = |&area: &u32| before.get(&area).map(|&(next, _)| next);
        let way = std::iter::successors(Some(from), step);
        way.filter_map(|area| before.get(&area).map(|&(_, passage)| passage))
            .collect()
    }

    /// The passages out of the area of a cell.
    pub fn from(&self, cell: usize) -> Vec<Passage> {
        let area = self.area.get(cell).copied().unwrap_or(NOWHERE);
        self.beside(area).map(|(_, passage)| passage).collect()
    }

    fn beside(&self, area: u32) -> impl Iterator<Item = (u32, Passage)> + '_ {
        self.between
            .iter()
            .filter_map(move |(&(a, b), &passage)| match area {
                _ if area == a => Some((b, passage)),
                _ if area == b => Some((a, passage)),
                _ => None,
            })
    }
}

/// By cell: which area of connected free cells it belongs to.
fn areas(cells: &Cells<'_>) -> Vec<u32> {
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
    area
}

/// The pixels from one back to the cells that its area grew from.
fn way(before: &[u32], pixel: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(Some(pixel), |&pixel| {
        Some(before[pixel] as usize).filter(|&earlier| earlier != pixel)
    })
}

/// The narrowest place on a way.
fn narrowest(cells: &Cells<'_>, way: impl Iterator<Item = usize>) -> Passage {
    let places = way.map(|pixel| (pixel % cells.map.width, pixel / cells.map.width));
    let widths = places.map(|(col, row)| (width_px(cells, col, row), (col, row)));
    let least = widths.min_by(|a, b| a.0.total_cmp(&b.0));
    let (width_px, (col, row)) = least.expect("a way has its first pixel");
    Passage {
        at_m: cells.map.in_map_m(col, row),
        width_m: width_px * cells.map.resolution_m,
    }
}

/// The shortest run of free pixels through a pixel, over the four directions; no longer than needed
/// to see that a cell would fit.
fn width_px(cells: &Cells<'_>, col: usize, row: usize) -> f64 {
    let run = |dx: isize, dy: isize| {
        let steps = (1..=cells.longest_run()).take_while(|&step: &isize| {
            let at = |from: usize, by: isize| from.checked_add_signed(by * step);
            let place = at(col, dx).zip(at(row, dy));
            place.is_some_and(|(col, row)| cells.is_free_pixel(col, row))
        });
        steps.count()
    };
    let directions: [(isize, isize); 4] = [(1, 0), (0, 1), (1, 1), (1, -1)];
    let lengths = directions.map(|(dx, dy)| {
        let pixels = 1 + run(dx, dy) + run(-dx, -dy);
        let diagonal = dx != 0 && dy != 0;
        pixels as f64
            * if diagonal {
                std::f64::consts::SQRT_2
            } else {
                1.0
            }
    });
    lengths.into_iter().fold(f64::INFINITY, f64::min)
}
