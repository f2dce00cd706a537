//! What holds for XCS whatever it meets.

use proptest::prelude::*;
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept};
use xcscr::xcs::{MatchSet, Params, Xcs};

const ACTIONS: usize = 3;

/// Lives through random percepts, actions and payoffs, and looks at the learner after each step.
fn live(seed: u64, steps: usize, params: Params, mut look: impl FnMut(&Xcs)) -> Xcs {
    let mut fate = Stream::new(seed, StreamName::World);
    let mut xcs = Xcs::new(params, ACTIONS, Stream::new(seed, StreamName::Evolution));
    let mut set = MatchSet::default();
    for _ in 0..steps {
        let percept = Percept::from_bits((0..7).map(|_| fate.chance(0.5))).unwrap();
        xcs.form_match_set(&percept, &mut set);
        let chosen = set
            .action_set(Action::new(fate.below(ACTIONS)).unwrap())
            .unwrap();
        let payoff = if percept.bit(0) {
            1000.0
        } else {
            900.0 * fate.unit()
        };
        xcs.update(&chosen, payoff, 0.2);
        xcs.evolve(&chosen);
        look(&xcs);
    }
    xcs
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_numerosity_sum_never_exceeds_n(seed in any::<u64>(), n in 32_u32..120) {
        let params = Params { population_size: n, theta_ga: 5, ..Params::default() };
        let mut greatest = 0;
        live(seed, 600, params, |xcs| {
            let rules = xcs.population().rules();
            let sum: u32 = rules.iter().map(|rule| rule.numerosity).sum();
            assert_eq!(sum, xcs.population().micro());
            greatest = greatest.max(sum);
        });
        prop_assert!(greatest <= n, "{} micro-classifiers of at most {}", greatest, n);
        prop_assert!(greatest > n / 2, "the population never filled: {} of {}", greatest, n);
    }

    #[test]
    fn figures_stay_finite_and_in_their_ranges(seed in any::<u64>()) {
        let params = Params { population_size: 200, theta_ga: 5, ..Params::default() };
        live(seed, 600, params, |xcs| {
            for rule in xcs.population().rules() {
                let sound = rule.prediction.is_finite()
                    && (0.0..=1000.0).contains(&rule.error)
                    && rule.fitness > 0.0 && rule.fitness <= 1.0 + 1e-9
                    && rule.numerosity >= 1;
                assert!(sound, "{rule:?}");
            }
        });
    }

    #[test]
    fn evaluation_never_changes_the_learner(seed in any::<u64>(), bits in "[01]{7}") {
        let xcs = live(seed, 200, Params::default(), |_| {});
        let before = xcs.clone();
        let _ = xcs.values(&bits.parse().unwrap());
        prop_assert_eq!(before, xcs);
    }

    #[test]
    fn a_saved_learner_goes_on_as_the_one_that_was_never_saved(seed in any::<u64>()) {
        let params = Params { population_size: 150, theta_ga: 5, ..Params::default() };
        let mut xcs = live(seed, 300, params.clone(), |_| {});
        let text = serde_json::to_string(&xcs.learned()).unwrap();
        let mut restored = Xcs::new(params, ACTIONS, Stream::new(0, StreamName::Evolution));
        prop_assert!(restored.resume(serde_json::from_str(&text).unwrap()));
        let mut fate = Stream::new(seed, StreamName::Start);
        for _ in 0..200 {
            let percept = Percept::from_bits((0..7).map(|_| fate.chance(0.5))).unwrap();
            let action = Action::new(fate.below(ACTIONS)).unwrap();
            for learner in [&mut xcs, &mut restored] {
                let mut set = MatchSet::default();
                learner.form_match_set(&percept, &mut set);
                let chosen = set.action_set(action).unwrap();
                learner.update(&chosen, 100.0 * f64::from(percept.bit(3)), 0.2);
                learner.evolve(&chosen);
            }
        }
        prop_assert_eq!(xcs, restored);
    }
}
