//! Learning curves: the mean number of steps in each episode over the trials of an arm.

use serde::{Deserialize, Serialize};

use crate::disk;
use crate::study::protocol::Arm;
use crate::study::statistics::{rounded, t_95};
use crate::study::store::StudyFolder;
use crate::study::store::outputs::LEARNING_CURVES;

/// A row of the table of learning curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    pub world: String,
    pub method: String,
    pub arena: String,
    pub sensor: String,
    pub variant: String,
    /// From 1.
    pub episode: u32,
    pub trials: u64,
    /// Mean steps of the episode, and Student's 95 % interval of this mean; the mean itself for a single trial.
    pub steps: f64,
    pub low: f64,
    pub high: f64,
}

/// Accumulates the episodes of an arm, trial by trial.
#[derive(Debug, Default)]
pub struct CurveSums {
    trials: u64,
    /// For each episode: the sum of the steps, and the sum of their squares.
    sums: Vec<(u64, u128)>,
}

impl CurveSums {
    /// Adds a trial with these steps per episode.
    pub fn add(&mut self, steps: impl Iterator<Item = u32>) {
        self.trials += 1;
        for (at, steps) in steps.enumerate() {
            if at == self.sums.len() {
                self.sums.push((0, 0));
            }
            let (sum, squares) = &mut self.sums[at];
            *sum += u64::from(steps);
            *squares += u128::from(steps) * u128::from(steps);
        }
    }

    /// Returns the curve of an arm.
    pub fn points(&self, arm: &Arm) -> Vec<CurvePoint> {
        let n = self.trials as f64;
        let t = t_95(self.trials);
        let point = |(at, &(sum, squares)): (usize, &(u64, u128))| {
            let mean = sum as f64 / n;
            // In integers, to lose no precision where the steps hardly differ.
            let deviation = u128::from(self.trials) * squares - u128::from(sum) * u128::from(sum);
            let variance = deviation as f64 / (n * (n - 1.0).max(1.0));
            let margin = t * (variance / n).sqrt();
            CurvePoint {
                world: arm.world.clone(),
                method: arm.method_name().to_owned(),
                arena: arm.arena.name().to_owned(),
                sensor: arm.sensor.name().to_owned(),
                variant: arm.variant.to_string(),
                episode: at as u32 + 1,
                trials: self.trials,
                steps: rounded(mean),
                low: rounded(mean - margin),
                high: rounded(mean + margin),
            }
        };
        self.sums.iter().enumerate().map(point).collect()
    }
}

impl StudyFolder {
    /// Returns the learning curve of each arm, as written with the episode table. `None` without a
    /// table.
    pub(in crate::study) fn learning_curves(&self) -> Option<Vec<Vec<CurvePoint>>> {
        let table = disk::read(&self.path().join(LEARNING_CURVES), disk::MOST_BYTES).ok()?;
        curves(&self.protocol().arms, self.protocol().episodes, &table)
    }
}

/// Parses a table of learning curves, and returns one curve for each arm. `None` if the table does
/// not match the arms and the number of episodes.
fn curves(arms: &[Arm], episodes: u32, table: &[u8]) -> Option<Vec<Vec<CurvePoint>>> {
    let rows = csv::Reader::from_reader(table).into_deserialize();
    let points: Vec<CurvePoint> = rows.collect::<Result<_, _>>().ok()?;
    let mut points = points.into_iter().peekable();
    let mut curves = Vec::new();
    for arm in arms {
        let is_of_arm = |point: &CurvePoint| {
            let names = [arm.method_name(), arm.arena.name(), arm.sensor.name()];
            let numbers = [point.steps, point.low, point.high];
            point.world == arm.world
                && [&point.method, &point.arena, &point.sensor] == names
                && point.variant == arm.variant.to_string()
                && (1..=episodes).contains(&point.episode)
                && numbers.iter().all(|number| number.is_finite())
        };
        let mut curve: Vec<CurvePoint> = Vec::new();
        while let Some(point) = points.next_if(|point| is_of_arm(point)) {
            curve.push(point);
        }
        curves.push(curve);
    }
    points.next().is_none().then_some(curves)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;

    /// By hand: 4, 6 and 11 have the mean 7 and the sample variance 13; 4.302653 times the root of 13/3 is 8.956686.
    #[test]
    fn the_interval_of_a_mean_is_that_of_student() {
        let mut sums = CurveSums::default();
        for steps in [4, 6, 11] {
            sums.add([steps, 5].into_iter());
        }
        let file =
            "name = \"a\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 3\nepisodes = 2";
        let arm = &frozen(file, &[]).unwrap().arms[0];
        let points = sums.points(arm);
        let figures = |point: &CurvePoint| [point.steps, point.low, point.high];
        assert_eq!(figures(&points[0]), [7.0, -1.956_686, 15.956_686]);
        assert_eq!(figures(&points[1]), [5.0, 5.0, 5.0]);
        assert_eq!((points[0].episode, points[0].trials), (1, 3));
        let mut table = csv::Writer::from_writer(Vec::new());
        points
            .iter()
            .for_each(|point| table.serialize(point).unwrap());
        let table = table.into_inner().unwrap();
        let arms = [arm.clone()];
        assert_eq!(curves(&arms, 2, &table), Some(vec![points]));
        // Control: a table with an episode that the study does not have is rejected.
        assert_eq!(curves(&arms, 1, &table), None);
    }
}
