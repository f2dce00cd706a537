//! The settings of a sweep whose results are nearest to the numbers of the paper.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::paper::AgainstPaper;
use crate::page::Table;
use crate::study::analysis::summary::ArmRecords;
use crate::study::protocol::{Protocol, Variant};
use crate::study::statistics::rounded;

/// Number of combinations in the table.
const BEST: usize = 10;

/// The distance of one combination of swept settings to the numbers of the paper.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearness {
    /// The settings of the sweep.
    pub variant: Variant,
    /// The sum of the squared standard scores of all numbers. By chance, it is about the count of
    /// numbers.
    pub distance: f64,
    /// By method, the successes in percent in each world, in the order of the study.
    pub numbers: Vec<(&'static str, Vec<u64>)>,
}

impl Nearness {
    /// Returns all combinations, the nearest first. Empty if the paper does not report the study's
    /// experiment.
    pub fn all(arms: &[ArmRecords<'_>], protocol: &Protocol) -> Vec<Self> {
        let mut found: Vec<Self> = Vec::new();
        for (variant, row) in AgainstPaper::of_sweep(arms, protocol) {
            let at = found.iter().position(|one| one.variant == variant);
            let at = at.unwrap_or_else(|| {
                found.push(Self {
                    variant,
                    distance: 0.0,
                    numbers: Vec::new(),
                });
                found.len() - 1
            });
            found[at].add(&row);
        }
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        found
    }

    fn add(&mut self, row: &AgainstPaper) {
        self.distance = rounded(self.distance + row.z * row.z);
        let percent = 100.0 * row.successes as f64 / row.trials.max(1) as f64;
        let number = percent.round() as u64;
        match self
            .numbers
            .iter_mut()
            .find(|(name, _)| *name == row.method)
        {
            Some((_, numbers)) => numbers.push(number),
            None => self.numbers.push((row.method, vec![number])),
        }
    }

    /// Returns the settings in a line, in the order of their names.
    fn settings(&self) -> String {
        let words = self.variant.to_string();
        words.replace(' ', ", ")
    }
}

/// Formats the best combinations as a table.
pub fn table(all: &[Nearness]) -> Table {
    let methods = all.first().map_or(&[][..], |one| &one.numbers);
    let columns = methods.iter().map(|(method, _)| (*method).to_owned());
    let header = ["rank".to_owned(), "distance".to_owned()].into_iter();
    let header = header.chain(columns).chain(["settings".to_owned()]);
    let mut table = Table::new(header);
    let row = |(rank, one): (usize, &Nearness)| {
        let numbers = one.numbers.iter().map(|(_, numbers)| {
            let words: Vec<String> = numbers.iter().map(u64::to_string).collect();
            words.join("/")
        });
        let first = [(rank + 1).to_string(), format!("{:.0}", one.distance)];
        let row = first.into_iter().chain(numbers);
        row.chain([one.settings()]).collect()
    };
    table.rows = all.iter().take(BEST).enumerate().map(row).collect();
    table
}

/// Returns the mean and the least distance of the combinations with each value of each setting.
pub fn effects(all: &[Nearness]) -> Table {
    let mut table = Table::new(["setting", "value", "combinations", "mean distance", "least"]);
    let keys: BTreeSet<&String> = all.iter().flat_map(|one| one.variant.0.keys()).collect();
    for key in keys {
        let mut by_value: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for one in all {
            let value = one.variant.0.get(key).map(ToString::to_string);
            let distances = by_value.entry(value.unwrap_or_default()).or_default();
            distances.push(one.distance);
        }
        for (value, distances) in by_value {
            let mean = distances.iter().sum::<f64>() / distances.len() as f64;
            let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
            table.rows.push(vec![
                key.clone(),
                value.trim_matches('"').to_owned(),
                distances.len().to_string(),
                format!("{mean:.0}"),
                format!("{least:.0}"),
            ]);
        }
    }
    table
}

/// Describes the tables.
pub fn legend(all: &[Nearness]) -> String {
    format!(
        "{} combinations of settings were run; the table lists the {} nearest to the paper. distance: \
         the sum of the squared standard scores between the paper's numbers and these. The nearest \
         of many is near partly by chance: repeat it with another `--seed` to confirm it.",
        all.len(),
        all.len().min(BEST)
    )
}
