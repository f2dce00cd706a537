//! The layout of a study's arms: a column for each place, a series for each method.

use crate::study::analysis::summary::ArmRecords;
use crate::study::protocol::Arm;

/// The arms of a study as a table of places and series.
#[derive(Debug)]
pub struct Panels<'a> {
    /// Episodes of a trial.
    pub episodes: u32,
    /// Worlds, with arena and sensor where a study has several.
    pub places: Vec<String>,
    /// Methods, with the settings that a sweep varies.
    pub series: Vec<String>,
    /// The trials of each arm.
    pub records: &'a [ArmRecords<'a>],
    /// The place and the series of each arm.
    positions: Vec<(usize, usize)>,
}

impl<'a> Panels<'a> {
    /// Arranges these arms.
    pub fn new(records: &'a [ArmRecords<'a>], episodes: u32) -> Self {
        let several = |differs: fn(&Arm, &Arm) -> bool| {
            records
                .windows(2)
                .any(|pair| differs(pair[0].arm, pair[1].arm))
        };
        let arenas = several(|a, b| a.arena != b.arena);
        let sensors = several(|a, b| a.sensor != b.sensor);
        let place = |arm: &Arm| {
            let arena = arenas.then(|| format!(", {}", arm.arena.name()));
            let sensor = sensors.then(|| format!(", {}", arm.sensor.name()));
            let differs = [arena, sensor].into_iter().flatten();
            arm.world.clone() + &differs.collect::<String>()
        };
        let (mut places, mut series) = (Vec::new(), Vec::new());
        let position = |ArmRecords { arm, .. }: &ArmRecords<'_>| {
            let who = format!("{} {}", arm.method_name(), arm.variant);
            let column = index_of(&mut places, &place(arm));
            (column, index_of(&mut series, &who.trim_end().to_owned()))
        };
        let positions = records.iter().map(position).collect();
        Self {
            episodes,
            places,
            series,
            records,
            positions,
        }
    }

    /// Returns the arm of a series in a place.
    pub fn arm(&self, place: usize, series: usize) -> Option<usize> {
        let mut positions = self.positions.iter();
        positions.position(|position| *position == (place, series))
    }

    /// Returns the trials of a series in a place.
    pub fn at(&self, place: usize, series: usize) -> Option<&'a ArmRecords<'a>> {
        Some(&self.records[self.arm(place, series)?])
    }
}

/// Returns the index of an item in a list. Adds the item if it is new.
pub fn index_of<T: PartialEq + Clone>(list: &mut Vec<T>, item: &T) -> usize {
    let known = list.iter().position(|known| known == item);
    known.unwrap_or_else(|| {
        list.push(item.clone());
        list.len() - 1
    })
}
