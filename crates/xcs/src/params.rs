//! The parameters of XCS, with all defaults in one place.

use serde::{Deserialize, Serialize};

use crate::bounds::{OutOfRange, within};

/// The greatest N.
pub(super) const GREATEST_POPULATION: u32 = 1_000_000;

/// Which of a rule's figures is updated first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpdateOrder {
    /// The error, with the old prediction (XCSJava 1.0, Butz 2000; XCSF): a rule that is paid for
    /// the first time gets its initial prediction's distance from the payoff as error.
    ErrorFirst,
    /// The prediction (the pseudo-code of Butz and Wilson 2001, UPDATE SET): a rule that is paid
    /// for the first time has no error, and counts as accurate.
    PredictionFirst,
}

/// Which of several equally general rules of \[A\] subsumes the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SubsumerTies {
    /// The first one in the order of \[P\].
    First,
    /// One after the other takes the place of the one before with probability 1/2 (Butz and
    /// Wilson 2001, DO ACTION SET SUBSUMPTION).
    Random,
}

/// Which steps the clock counts that tells when the GA is due.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GaClock {
    /// All (Butz and Wilson 2001, RUN EXPERIMENT: t grows with every step).
    AllSteps,
    /// Only those in which the GA may run, and not those of episodes that only exploit (XCSJava
    /// 1.0, Butz 2000).
    EvolvingSteps,
}

/// Parameters of XCS (Butz and Wilson 2001, section 3.2; values of the paper's experiment where
/// it prints them, calibrated ones elsewhere).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// N: the most micro-classifiers in \[P\]; 32 to 1,000,000. Too few, and rules that are
    /// needed get deleted.
    pub population_size: u32,
    /// P#: the probability of a don't-care in covering; 0 to 1.
    pub dont_care: f64,
    /// beta: the learning rate; above 0, at most 1.
    pub beta: f64,
    /// alpha: the drop in accuracy at the error threshold; 0 to 1.
    pub alpha: f64,
    /// epsilon_0: the error up to which a rule counts as accurate, in units of reward; above 0.
    /// Two payoffs that differ by less are one payoff to XCS.
    pub epsilon_0: f64,
    /// nu: the power with which accuracy falls with error; 1 to 20, a whole number so that no
    /// platform-dependent `pow` is needed.
    pub nu: u32,
    /// theta_GA: mean steps between two runs of the GA in one niche; 0 to 1,000,000.
    pub theta_ga: u32,
    /// chi: the probability of crossover; 0 to 1.
    pub chi: f64,
    /// mu: the probability of mutating one allele or the action; 0 to 1.
    pub mu: f64,
    /// theta_del: experience from which on low fitness counts in deletion; 0 to 1,000,000.
    pub theta_del: u32,
    /// delta: the fraction of the mean fitness below which a rule is unfit; 0 to 1.
    pub delta: f64,
    /// theta_sub: experience from which on a rule can subsume others; 0 to 1,000,000.
    pub theta_sub: u32,
    /// zeta: the fraction of the greatest worth from which on a payoff counts as the best, for
    /// `xcsam` (Nakata, Lanzi and Takadama 2012); 0 to 1.
    pub zeta: f64,
    /// p_I: the prediction of a covering rule, in units of reward; -1,000,000 to 1,000,000.
    pub initial_prediction: f64,
    /// epsilon_I: the error of a covering rule, in units of reward; 0 to 1,000,000.
    pub initial_error: f64,
    /// F_I: the fitness of a covering rule; above 0, at most 1.
    pub initial_fitness: f64,
    /// Does the GA run?
    pub ga: bool,
    /// Do parents subsume their children?
    pub ga_subsumption: bool,
    /// Does the most general accurate rule of \[A\] subsume the others?
    pub action_set_subsumption: bool,
    /// Divide the worth by the fitness of all of \[M\], as Eq. 6 is printed in the paper, and not
    /// by that of the rules with the action, as in XCS.
    pub worth_over_match_set: bool,
    /// Which of a rule's figures is updated first, error or prediction.
    pub update_order: UpdateOrder,
    /// Which of several equally general rules subsumes the others of \[A\].
    pub subsumer_ties: SubsumerTies,
    /// Which steps the GA's clock counts.
    pub ga_clock: GaClock,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            population_size: 1600,
            dont_care: 0.3,
            beta: 0.2,
            alpha: 0.1,
            epsilon_0: 10.0,
            nu: 5,
            theta_ga: 25,
            chi: 0.8,
            mu: 0.04,
            theta_del: 20,
            delta: 0.1,
            theta_sub: 20,
            zeta: 0.99,
            initial_prediction: 0.0,
            initial_error: 0.0,
            initial_fitness: 0.01,
            ga: true,
            ga_subsumption: true,
            action_set_subsumption: true,
            worth_over_match_set: false,
            update_order: UpdateOrder::ErrorFirst,
            subsumer_ties: SubsumerTies::First,
            ga_clock: GaClock::AllSteps,
        }
    }
}

impl Params {
    /// Accepts the parameters when each lies in its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        const MILLION: u32 = 1_000_000;
        let sizes = 32..=GREATEST_POPULATION;
        within("xcs.population_size", self.population_size, sizes)?;
        within("xcs.dont_care", self.dont_care, 0.0..=1.0)?;
        within("xcs.beta", self.beta, 1e-6..=1.0)?;
        within("xcs.alpha", self.alpha, 0.0..=1.0)?;
        within("xcs.epsilon_0", self.epsilon_0, 1e-9..=1e6)?;
        within("xcs.nu", self.nu, 1..=20)?;
        within("xcs.theta_ga", self.theta_ga, 0..=MILLION)?;
        within("xcs.chi", self.chi, 0.0..=1.0)?;
        within("xcs.mu", self.mu, 0.0..=1.0)?;
        within("xcs.theta_del", self.theta_del, 0..=MILLION)?;
        within("xcs.delta", self.delta, 0.0..=1.0)?;
        within("xcs.theta_sub", self.theta_sub, 0..=MILLION)?;
        within("xcs.zeta", self.zeta, 0.0..=1.0)?;
        within(
            "xcs.initial_prediction",
            self.initial_prediction,
            -1e6..=1e6,
        )?;
        within("xcs.initial_error", self.initial_error, 0.0..=1e6)?;
        within("xcs.initial_fitness", self.initial_fitness, 1e-9..=1.0)
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
        let fields: [fn(&mut Params) -> &mut f64; 11] = [
            |p| &mut p.dont_care,
            |p| &mut p.beta,
            |p| &mut p.alpha,
            |p| &mut p.epsilon_0,
            |p| &mut p.chi,
            |p| &mut p.mu,
            |p| &mut p.delta,
            |p| &mut p.zeta,
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
