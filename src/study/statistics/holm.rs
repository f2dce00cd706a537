//! Holm's correction for several tests.

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
