//! Which settings of a sweep come nearest to the numbers of the paper.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::paper::AgainstPaper;
use crate::page::Table;
use crate::study::analysis::summary::{ArmRecords, rounded};
use crate::study::protocol::{Protocol, Variant};

/// How many settings are told.
const BEST: usize = 10;

/// One combination of swept settings next to the numbers of the paper.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearness {
    /// What the sweep sets.
    pub variant: Variant,
    /// The sum of the squared standard scores of all numbers; by chance, about as many as there
    /// are numbers.
    pub distance: f64,
    /// By method, the successes in percent in each world, in the order of the study.
    pub numbers: Vec<(&'static str, Vec<u64>)>,
}

impl Nearness {
    /// All combinations, the nearest first; nothing for a study that varies no setting, or whose
    /// experiment the paper does not report.
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

    /// The settings as a line for each, in the order of their names.
    fn settings(&self) -> String {
        let words = self.variant.to_string();
        words.replace(' ', ", ")
    }
}

/// The best combinations as a table.
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

/// How far, on average, the combinations with each value of each setting are from the paper.
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

/// What the tables mean.
pub fn legend(all: &[Nearness]) -> String {
    format!(
        "{} combinations of settings were tried; the {} nearest to the paper stand above. distance: \
         the sum of the squared standard scores between the paper's numbers and these. The nearest \
         of many is near in part by luck: run it again with another `--seed` before believing it.",
        all.len(),
        all.len().min(BEST)
    )
}
