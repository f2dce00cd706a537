//! Least squares with errors that hold for observations in groups.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

/// The least number of groups that tell a standard error.
const LEAST_GROUPS: usize = 10;

/// A linear observation: its factors, the observed value, and the number of its group.
pub struct Observation {
    pub factors: Vec<f64>,
    pub value: f64,
    pub group: usize,
}

/// Returns each coefficient with its standard error; `None` if the observations do not determine
/// them. Observations of a group may have errors in common (cluster-robust: Liang and Zeger 1986).
pub fn fitted(all: &[Observation]) -> Option<Vec<[f64; 2]>> {
    let (design, observed) = matrices(all)?;
    let inverse = (design.transpose() * &design).try_inverse()?;
    let coefficients = &inverse * design.transpose() * &observed;
    let residuals = observed - &design * &coefficients;
    let mut groups: BTreeMap<usize, DVector<f64>> = BTreeMap::new();
    for (number, observation) in all.iter().enumerate() {
        let pull = design.row(number).transpose() * residuals[number];
        let none = || DVector::zeros(coefficients.len());
        *groups.entry(observation.group).or_insert_with(none) += pull;
    }
    if groups.len() < LEAST_GROUPS {
        return None;
    }
    let count = groups.len() as f64;
    let spread: DMatrix<f64> = groups.values().map(|pull| pull * pull.transpose()).sum();
    let covariance = &inverse * spread * &inverse * (count / (count - 1.0));
    let with_error = |(at, value): (usize, &f64)| [*value, covariance[(at, at)].sqrt()];
    let fitted: Vec<_> = coefficients.iter().enumerate().map(with_error).collect();
    let is_known = fitted.iter().flatten().all(|number| number.is_finite());
    is_known.then_some(fitted)
}

/// Returns the factors and the observed values.
pub fn matrices(all: &[Observation]) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let columns = all.first()?.factors.len();
    let factors = all.iter().flat_map(|one| one.factors.iter().copied());
    let values = all.iter().map(|one| one.value);
    (all.len() > columns).then(|| {
        let design = DMatrix::from_row_iterator(all.len(), columns, factors);
        (design, DVector::from_iterator(all.len(), values))
    })
}
