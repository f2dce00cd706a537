//! The ranking of candidates, and their elimination.

use serde::Serialize;

/// A candidate that is behind the leader by more than this many standard errors of the paired
/// difference is eliminated early. The limit is three because many candidates are tested many
/// times.
const SIGNIFICANT_ERRORS: f64 = 3.0;
/// With fewer pairs, the standard error is too uncertain.
const MIN_PAIRS: usize = 10;

/// The outcome of a candidate in a rung.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The candidate is in the next rung.
    Stays,
    /// The candidate is in the worse half.
    Halved,
    /// The candidate is significantly worse than the leader.
    Worse,
}

/// A candidate after a rung.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Standing {
    /// Method, arena, percept and settings.
    pub candidate: String,
    /// Number of its trials so far, in all rungs.
    pub trials: usize,
    /// Mean number of episodes until the policy was optimal. A trial whose policy was never optimal
    /// counts as its number of episodes plus one.
    pub episodes: f64,
    /// Mean difference of `episodes` to the leader, with the same seeds.
    pub behind: f64,
    /// The standard error of `behind`; 0 for the leader.
    pub behind_error: f64,
    /// The outcome in this rung.
    pub verdict: Verdict,
}

/// Ranks candidates by their scores, the best first. The scores are paired. At most `places`
/// candidates stay.
pub(super) fn standings(scores: &[(String, Vec<f64>)], places: usize) -> Vec<Standing> {
    let mut order: Vec<&(String, Vec<f64>)> = scores.iter().collect();
    order.sort_by(|a, b| mean(&a.1).total_cmp(&mean(&b.1)));
    let Some((_, leader)) = order.first() else {
        return vec![];
    };
    let standing = |(place, (name, scores)): (usize, &&(String, Vec<f64>))| {
        let (behind, behind_error) = difference(scores, leader);
        let is_significant =
            scores.len() >= MIN_PAIRS && behind > SIGNIFICANT_ERRORS * behind_error;
        Standing {
            candidate: name.clone(),
            trials: scores.len(),
            episodes: mean(scores),
            behind,
            behind_error,
            verdict: match (place, place < places) {
                (0, _) => Verdict::Stays,
                _ if is_significant => Verdict::Worse,
                (_, true) => Verdict::Stays,
                (_, false) => Verdict::Halved,
            },
        }
    };
    order.iter().enumerate().map(standing).collect()
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len().max(1) as f64
}

/// Returns the mean of the paired differences, and its standard error.
fn difference(a: &[f64], b: &[f64]) -> (f64, f64) {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let (mean, count) = (mean(&differences), differences.len() as f64);
    let square = |one: &f64| (one - mean) * (one - mean);
    let squares: f64 = differences.iter().map(square).sum();
    (mean, (squares / (count - 1.0).max(1.0) / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scores(name: &str, add: f64, count: usize) -> (String, Vec<f64>) {
        let wave = |i| f64::from(i * 7 % 11) + add * f64::from(1 + i % 3);
        (name.to_owned(), (0..).map(wave).take(count).collect())
    }

    #[test]
    fn the_worse_half_and_significantly_worse_candidates_are_eliminated() {
        let all = [
            scores("c", 0.1, 12),
            scores("a", 0.0, 12),
            scores("d", 9.0, 12),
        ];
        let found = standings(&all, 3);
        let names: Vec<&str> = found.iter().map(|one| &one.candidate[..]).collect();
        assert_eq!(names, ["a", "c", "d"]);
        assert_eq!(found[0].verdict, Verdict::Stays);
        assert_eq!(found[2].verdict, Verdict::Worse);
        assert_eq!(
            standings(&all, 1)[1].verdict,
            Verdict::Worse,
            "every pair says so"
        );
    }

    #[test]
    fn few_pairs_or_a_small_difference_eliminate_no_candidate_early() {
        let found = standings(&[scores("a", 0.0, 9), scores("d", 9.0, 9)], 2);
        assert_eq!(found[1].verdict, Verdict::Stays, "nine pairs");
        let mut close = scores("b", 0.0, 40);
        for (i, score) in close.1.iter_mut().enumerate() {
            *score += if i % 2 == 0 { 3.0 } else { -2.5 };
        }
        let found = standings(&[scores("a", 0.0, 40), close], 2);
        assert_eq!(found[1].verdict, Verdict::Stays, "{found:?}");
        let halved = standings(&[scores("a", 0.0, 9), scores("d", 9.0, 9)], 1);
        assert_eq!(halved[1].verdict, Verdict::Halved);
    }
}
