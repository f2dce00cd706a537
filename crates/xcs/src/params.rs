//! The parameters of XCS, with all defaults in one place.

use serde::{Deserialize, Serialize};

use crate::settings;

/// The largest allowed population size N.
pub(crate) const GREATEST_POPULATION: u32 = 1_000_000;

/// The order in which a rule's prediction and error are updated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpdateOrder {
    /// The error first, with the old prediction (XCSJava 1.0, Butz 2000; XCSF). After its first
    /// payoff, a rule's error is the distance of its initial prediction from the payoff.
    ErrorFirst,
    /// The prediction first (the pseudo-code of Butz and Wilson 2001, UPDATE SET). After its first
    /// payoff, a rule has no error and counts as accurate.
    PredictionFirst,
}

/// The choice among equally general rules of \[A\] as the subsumer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SubsumerTies {
    /// The first one in the order of \[P\].
    First,
    /// Each further rule replaces the current choice with probability 1/2 (Butz and Wilson 2001, DO
    /// ACTION SET SUBSUMPTION).
    Random,
}

/// The steps counted by the clock that decides when the GA is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GaClock {
    /// All steps (Butz and Wilson 2001, RUN EXPERIMENT: t grows with every step).
    AllSteps,
    /// Only steps in which the GA may run, excluding episodes that only exploit (XCSJava 1.0, Butz
    /// 2000).
    EvolvingSteps,
}

/// The statistics of a rule that learn at the rate of an update, where that rate differs from `xcs.beta`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RateScope {
    /// Prediction, error, set size and fitness.
    All,
    /// Only the prediction (paper, section III-C: learning-rate switching changes beta of Eq. 1). All other statistics
    /// learn at `xcs.beta`.
    Prediction,
}

settings! {
    section "xcs";

    /// Parameters of XCS (Butz and Wilson 2001, section 3.2; values of the paper's experiment where
    /// it prints them, calibrated ones elsewhere).
    pub struct Params {
        /// N: the maximum number of micro-classifiers in \[P\]. If it is too small, needed rules are deleted.
        population_size: u32 = 1600, in 32..=GREATEST_POPULATION;
        /// P#: the probability of a don't-care in covering.
        dont_care: f64 = 0.3, in 0.0..=1.0;
        /// beta: the learning rate. With learning-rate switching, `reward.beta_success`, `reward.beta_failure` and
        /// `reward.beta_collision` replace it.
        beta: f64 = 0.2, in 1e-6..=1.0;
        /// alpha: the drop in accuracy at the error threshold.
        alpha: f64 = 0.1, in 0.0..=1.0;
        /// epsilon_0: the error up to which a rule counts as accurate, in units of reward. XCS
        /// does not distinguish payoffs that differ by less.
        epsilon_0: f64 = 10.0, in 1e-9..=1e6;
        /// nu: the exponent with which accuracy falls with error; an integer, so that no
        /// platform-dependent `pow` is needed.
        nu: u32 = 5, in 1..=20;
        /// theta_GA: the mean number of steps between two runs of the GA in one action set.
        theta_ga: u32 = 25, in 0..=1_000_000;
        /// chi: the probability of crossover.
        chi: f64 = 0.8, in 0.0..=1.0;
        /// mu: the probability of mutating one allele or the action.
        mu: f64 = 0.04, in 0.0..=1.0;
        /// theta_del: the experience above which low fitness raises the deletion vote.
        theta_del: u32 = 20, in 0..=1_000_000;
        /// delta: the fraction of the mean fitness below which a rule is unfit.
        delta: f64 = 0.1, in 0.0..=1.0;
        /// theta_sub: the experience above which a rule can subsume others.
        theta_sub: u32 = 20, in 0..=1_000_000;
        /// p_I: the prediction of a covering rule, in units of reward.
        initial_prediction: f64 = 0.0, in -1e6..=1e6;
        /// epsilon_I: the error of a covering rule, in units of reward.
        initial_error: f64 = 0.0, in 0.0..=1e6;
        /// F_I: the fitness of a covering rule.
        initial_fitness: f64 = 0.01, in 1e-9..=1.0;
        /// Run the GA.
        ga: bool = true;
        /// Let parents subsume their children.
        ga_subsumption: bool = true;
        /// Let the most general accurate rule of \[A\] subsume the others.
        action_set_subsumption: bool = true;
        /// Divide the value by the fitness of all of \[M\], as Eq. 6 is printed in the paper. XCS
        /// divides by the fitness of the rules with the action.
        value_over_match_set: bool = false;
        /// Whether a rule's error (`error-first`) or its prediction (`prediction-first`) is updated
        /// first.
        update_order: UpdateOrder = UpdateOrder::ErrorFirst;
        /// While a rule is young, make its statistics the means of its payoffs (MAM: the rate is at least 1 divided by
        /// the experience; Butz and Wilson 2001). Eq. 1 of the paper has no such term.
        mean_while_young: bool = true;
        /// Which statistics of a rule learn at a switched rate, such as `reward.beta_failure`. `all`: prediction, error,
        /// set size and fitness. `prediction`: only the prediction.
        rate_scope: RateScope = RateScope::All;
        /// Which of several equally general rules subsumes the others of \[A\]. `first`: the first
        /// one in \[P\]. `random`: each further rule replaces the choice with probability 1/2.
        subsumer_ties: SubsumerTies = SubsumerTies::First;
        /// Which steps the GA's clock counts. `all-steps`: all. `evolving-steps`: only steps in which
        /// the GA may run.
        ga_clock: GaClock = GaClock::AllSteps;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(change: impl FnOnce(&mut Params)) -> String {
        let mut params = Params::default();
        change(&mut params);
        params.check().unwrap_err().to_string()
    }

    #[test]
    fn the_defaults_lie_in_their_ranges() {
        Params::default().check().unwrap();
    }

    #[test]
    fn a_refused_value_is_named_with_its_range() {
        assert_eq!(
            refusal(|p| p.beta = 0.0),
            "`xcs.beta` is 0, but must be from 0.000001 to 1"
        );
        assert_eq!(
            refusal(|p| p.population_size = 0),
            "`xcs.population_size` is 0, but must be from 32 to 1000000"
        );
    }

    #[test]
    fn not_a_number_is_refused_in_every_field() {
        let fields: [fn(&mut Params) -> &mut f64; 10] = [
            |p| &mut p.dont_care,
            |p| &mut p.beta,
            |p| &mut p.alpha,
            |p| &mut p.epsilon_0,
            |p| &mut p.chi,
            |p| &mut p.mu,
            |p| &mut p.delta,
            |p| &mut p.initial_prediction,
            |p| &mut p.initial_error,
            |p| &mut p.initial_fitness,
        ];
        for field in fields {
            let message = refusal(|p| *field(p) = f64::NAN);
            assert!(message.contains("NaN"), "{message}");
        }
    }
}
