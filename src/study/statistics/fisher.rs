//! Fisher's exact test for two proportions, and Holm's correction for several tests.

use statrs::distribution::{Discrete, Hypergeometric};

use super::Proportion;

/// Relative tolerance on the probabilities of tables. Two tables that differ only by rounding are
/// equally likely.
const ALIKE: f64 = 1e-7;

/// Returns the two-sided p of Fisher's exact test that two proportions are the same: the total
/// probability of all tables with the same margins that are not more likely than this one.
pub fn fisher_exact(a: Proportion, b: Proportion) -> f64 {
    let successes = a.successes + b.successes;
    let tables = Hypergeometric::new(a.trials + b.trials, successes, a.trials)
        .expect("neither successes nor draws are more than there are trials");
    // Logarithms, because the probabilities of large tables underflow.
    let limit = tables.ln_pmf(a.successes) + ALIKE;
    let possible = successes.saturating_sub(b.trials)..=successes.min(a.trials);
    let unlikely = possible
        .map(|of_a| tables.ln_pmf(of_a))
        .filter(|&ln| ln <= limit);
    unlikely.map(f64::exp).sum::<f64>().clamp(0.0, 1.0)
}

/// Applies Holm's correction (1979) to several tests of one question.
pub fn holm(ps: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..ps.len()).collect();
    order.sort_by(|&a, &b| ps[a].total_cmp(&ps[b]));
    let mut corrected = vec![0.0; ps.len()];
    let mut least: f64 = 0.0;
    for (rank, &i) in order.iter().enumerate() {
        least = least.max(ps[i] * (ps.len() - rank) as f64).min(1.0);
        corrected[i] = least;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::statistics::assert_close;

    fn of_100(successes: u64) -> Proportion {
        Proportion::new(successes, 100)
    }

    #[test]
    fn the_papers_own_comparisons_as_in_scipy() {
        // scipy 1.17.1: fisher_exact([[a, 100 - a], [b, 100 - b]]).pvalue
        for (a, b, p) in FISHER {
            assert_close(fisher_exact(of_100(a), of_100(b)), p);
            assert_close(fisher_exact(of_100(b), of_100(a)), p);
        }
    }

    const FISHER: [(u64, u64, f64); 5] = [
        (79, 77, 0.8646226720683615),
        (54, 29, 0.0005359383566450098),
        (65, 25, 1.917475680382752e-8),
        (0, 0, 1.0),
        (100, 0, 2.208760693199503e-59),
    ];

    #[test]
    fn p_of_large_tables_as_in_scipy() {
        // scipy 1.17.1: fisher_exact([[a, 800 - a], [b, 800 - b]]).pvalue
        for (a, b, p) in LARGE {
            let of_800 = |successes| Proportion::new(successes, 800);
            let found = fisher_exact(of_800(a), of_800(b));
            assert!((found / p - 1.0).abs() < 1e-6, "{found} is not {p}");
        }
    }

    const LARGE: [(u64, u64, f64); 2] = [
        (400, 256, 3.069423995468752e-13),
        (300, 290, 0.6409797904327046),
    ];

    #[test]
    fn p_stays_between_zero_and_one() {
        for a in 0..=100 {
            for b in 0..=100 {
                let p = fisher_exact(of_100(a), of_100(b));
                assert!((0.0..=1.0).contains(&p), "{a} {b}: {p}");
            }
        }
        let none = Proportion::new(0, 0);
        assert_eq!(fisher_exact(none, none), 1.0);
    }

    #[test]
    fn holm_as_in_r() {
        // R: p.adjust(c(0.04, 0.01, 0.03), "holm") gives 0.06 0.03 0.06.
        for (actual, expected) in holm(&[0.04, 0.01, 0.03])
            .into_iter()
            .zip([0.06, 0.03, 0.06])
        {
            assert_close(actual, expected);
        }
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
        assert!(holm(&[]).is_empty());
    }
}
