//! What holds for XCS whatever it meets.

use proptest::prelude::*;
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, MatchSet, Params, Percept, Xcs};

const ACTIONS: usize = 3;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Lives through random percepts, actions and payoffs.
    #[test]
    fn figures_stay_in_their_ranges_and_numerosities_never_exceed_n(seed in any::<u64>(), n in 32_u32..120) {
        let params = Params { population_size: n, theta_ga: 5, ..Params::default() };
        let mut fate = Stream::new(seed, StreamName::World);
        let mut xcs = Xcs::new(params, ACTIONS, Stream::new(seed, StreamName::Evolution));
        let (mut set, mut greatest) = (MatchSet::default(), 0);
        for _ in 0..600 {
            let percept = Percept::from_bits((0..7).map(|_| fate.chance(0.5))).unwrap();
            xcs.form_match_set(&percept, &mut set);
            let action = Action::new(fate.below(ACTIONS)).unwrap();
            let chosen = set.action_set(action).unwrap();
            let payoff = if percept.bit(0) { 1000.0 } else { 900.0 * fate.unit() };
            xcs.update(&chosen, payoff, 0.2);
            xcs.evolve(&chosen);
            let rules = xcs.population().rules();
            for rule in rules {
                let sound = rule.prediction.is_finite()
                    && (0.0..=1000.0).contains(&rule.error)
                    && rule.fitness > 0.0 && rule.fitness <= 1.0 + 1e-9
                    && rule.numerosity >= 1;
                prop_assert!(sound, "{:?}", rule);
            }
            let sum: u32 = rules.iter().map(|rule| rule.numerosity).sum();
            prop_assert_eq!(sum, xcs.population().micro());
            greatest = greatest.max(sum);
        }
        prop_assert!(greatest <= n, "{} micro-classifiers of at most {}", greatest, n);
        prop_assert!(greatest > n / 2, "the population never filled: {} of {}", greatest, n);
    }
}
