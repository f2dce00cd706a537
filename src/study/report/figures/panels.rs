//! How the arms of a study are laid out: a column for each place, a series for each method.

use crate::study::analysis::summary::ArmRecords;
use crate::study::protocol::Arm;

/// The arms of a study as a table: where the trials ran, and who ran.
#[derive(Debug)]
pub struct Panels<'a> {
    /// Episodes of a trial.
    pub episodes: u32,
    /// Worlds, with arena and sensor where a study has several.
    pub places: Vec<String>,
    /// Methods, with the settings that a sweep varies.
    pub series: Vec<String>,
    records: &'a [ArmRecords<'a>],
    /// Place and series of each arm.
    spots: Vec<(usize, usize)>,
}

impl<'a> Panels<'a> {
    /// The table of these arms.
    pub fn new(records: &'a [ArmRecords<'a>], episodes: u32) -> Self {
        let several = |differs: fn(&Arm, &Arm) -> bool| {
            records
                .windows(2)
                .any(|pair| differs(pair[0].arm, pair[1].arm))
        };
        let arenas = several(|a, b| a.arena != b.arena);
        let sensors = several(|a, b| a.sensor != b.sensor);
        let place = |arm: &Arm| {
            let arena = if arenas {
                format!(", {}", arm.arena.name())
            } else {
                String::new()
            };
            let sensor = if sensors {
                format!(", {}", arm.sensor.name())
            } else {
                String::new()
            };
            format!("{}{arena}{sensor}", arm.world)
        };
        let (mut places, mut series) = (Vec::new(), Vec::new());
        let spot = |ArmRecords { arm, .. }: &ArmRecords<'_>| {
            let who = format!("{} {}", arm.method_name(), arm.variant);
            let column = index_of(&mut places, place(arm));
            (column, index_of(&mut series, who.trim_end().to_owned()))
        };
        let spots = records.iter().map(spot).collect();
        Self {
            episodes,
            places,
            series,
            records,
            spots,
        }
    }

    /// Which arm is the one of this series in this place.
    pub fn arm(&self, place: usize, series: usize) -> Option<usize> {
        let mut spots = self.spots.iter();
        spots.position(|spot| *spot == (place, series))
    }

    /// The trials of one series in one place.
    pub fn at(&self, place: usize, series: usize) -> Option<&'a ArmRecords<'a>> {
        Some(&self.records[self.arm(place, series)?])
    }
}

/// The place of a name in a list, to which it is added if it is new.
fn index_of(names: &mut Vec<String>, name: String) -> usize {
    names
        .iter()
        .position(|known| *known == name)
        .unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        })
}
