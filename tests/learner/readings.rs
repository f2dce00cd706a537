//! Each doubtful reading of the paper is one setting. Here each setting is turned, and what it
//! changes is computed by hand; the control is the other reading.

use xcscr::agent::{Agent, Method, Setup, StackEvolution, StepLimitUpdate, Transition, XcsPayment};
use xcscr::arena::Outcome;
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{
    self, Action, GaClock, MatchSet, Percept, RateScope, SubsumerTies, UpdateOrder, Xcs,
};

const BUMP: Outcome = Outcome::Collided { impulse_n_s: None };

fn percept(bits: &str) -> Percept {
    bits.parse().unwrap()
}

fn action(number: usize) -> Action {
    Action::new(number).unwrap()
}

/// Specific rules, and no discovery beside covering.
fn plain() -> xcs::Params {
    xcs::Params {
        dont_care: 0.0,
        ga: false,
        ga_subsumption: false,
        action_set_subsumption: false,
        ..xcs::Params::default()
    }
}

/// A learner with one of the readings.
fn learner(seed: u64, read: impl FnOnce(&mut xcs::Params)) -> Xcs {
    let mut params = plain();
    read(&mut params);
    Xcs::new(params, 2, Stream::new(seed, StreamName::Evolution))
}

/// A method with one of the readings.
fn method(method: Method, read: impl FnOnce(&mut Setup)) -> Box<dyn Agent> {
    let mut setup = Setup {
        xcs: plain(),
        ..Setup::default()
    };
    read(&mut setup);
    method.build(2, 0, setup, 1)
}

/// Takes action 0 in a percept, as the last step of an episode.
fn take(method: &mut dyn Agent, bits: &str, outcome: Outcome) {
    let percept = percept(bits);
    method.observe(&percept);
    method.update(&Transition {
        percept: &percept,
        place: None,
        action: action(0),
        outcome,
        next: None,
    });
}

/// Runs an episode of action 0 in these percepts, each with its outcome, and ends it.
fn episode(method: &mut dyn Agent, steps: &[(&str, Outcome)], reached_goal: bool) {
    for (bits, outcome) in steps {
        take(method, bits, *outcome);
    }
    method.end_episode(reached_goal);
}

fn values(method: &dyn Agent, bits: &str) -> f64 {
    method.values(&percept(bits)).get(action(0)).unwrap()
}

/// Returns prediction and error of a new rule after each of these payoffs, learned at `rate`.
fn after_payoffs(
    payoffs: [f64; 2],
    rate: f64,
    read: impl FnOnce(&mut xcs::Params),
) -> [(f64, f64); 2] {
    let mut xcs = learner(1, read);
    let mut set = MatchSet::default();
    xcs.form_match_set(&percept("01"), &mut set);
    let set = set.action_set(action(0)).unwrap();
    payoffs.map(|payoff| {
        xcs.update(&set, payoff, rate);
        let rules = xcs.population().rules();
        let rule = rules.iter().find(|rule| rule.action == action(0)).unwrap();
        (rule.prediction, rule.error)
    })
}

#[test]
fn a_young_rule_predicts_the_mean_of_its_payoffs_or_learns_at_beta_from_the_first() {
    let found = |mean| {
        after_payoffs([1000.0, 500.0], 0.2, |params| {
            params.mean_while_young = mean
        })
    };
    assert_eq!(found(true), [(1000.0, 1000.0), (750.0, 750.0)]);
    // 0.2 x 1000, and 200 + 0.2 x (500 - 200); the errors are 1000 and 300.
    assert_eq!(found(false), [(200.0, 200.0), (260.0, 220.0)]);
}

#[test]
fn a_switched_rate_drives_all_statistics_or_only_the_prediction() {
    let found = |scope| {
        after_payoffs([1000.0, 1000.0], 0.05, |params| {
            (params.mean_while_young, params.rate_scope, params.beta) = (false, scope, 0.5);
        })
    };
    // 0.05 x 1000, and 50 + 0.05 x (950 - 50).
    assert_eq!(found(RateScope::All), [(50.0, 50.0), (97.5, 95.0)]);
    // 0.5 x 1000, and 500 + 0.5 x (950 - 500).
    assert_eq!(found(RateScope::Prediction), [(50.0, 500.0), (97.5, 725.0)]);
}

#[test]
fn the_first_payoff_is_an_error_only_if_the_error_is_updated_before_the_prediction() {
    let after_two_payoffs = |update_order| {
        after_payoffs([1000.0, 500.0], 0.2, |params| {
            params.update_order = update_order
        })
    };
    // |1000 - 0| = 1000; then the mean of 1000 and |500 - 1000|.
    let found = after_two_payoffs(UpdateOrder::ErrorFirst);
    assert_eq!(found, [(1000.0, 1000.0), (750.0, 750.0)]);
    // |1000 - 1000| = 0; then the mean of 0 and |500 - 750|.
    let found = after_two_payoffs(UpdateOrder::PredictionFirst);
    assert_eq!(found, [(1000.0, 0.0), (750.0, 125.0)]);
}

#[test]
fn the_gas_clock_counts_episodes_that_only_exploit_or_does_not() {
    let rules_after_waiting_in_exploitation = |ga_clock| {
        let mut xcs = learner(1, |params| {
            (params.ga, params.mu, params.ga_clock) = (true, 1.0, ga_clock);
        });
        let mut set = MatchSet::default();
        xcs.let_evolve(false);
        for _ in 0..40 {
            xcs.form_match_set(&percept("0101"), &mut set);
        }
        xcs.let_evolve(true);
        xcs.form_match_set(&percept("0101"), &mut set);
        let before = xcs.population().micro();
        xcs.evolve(&set.action_set(action(0)).unwrap());
        xcs.population().micro() - before
    };
    let children = rules_after_waiting_in_exploitation;
    assert_eq!(children(GaClock::AllSteps), 2, "41 steps are more than 25");
    assert_eq!(children(GaClock::EvolvingSteps), 0, "one step is not");
}

#[test]
fn of_equally_general_rules_the_first_subsumes_or_either() {
    let survivors = |subsumer_ties| {
        let survivor = |seed| {
            // Three rules that overlap: two of them equally general, both more so than the third.
            let rules = ["1#", "#1", "11"].map(|condition| {
                let condition = condition.parse().unwrap();
                let rule = xcs::Classifier::new(condition, action(0), 0, &plain());
                xcs::Classifier {
                    experience: 30,
                    ..rule
                }
            });
            let rules = xcs::Population::try_from(rules.to_vec()).unwrap();
            let xcs = learner(seed, |params| {
                params.action_set_subsumption = true;
                params.subsumer_ties = subsumer_ties;
            });
            let mut xcs = xcs.with_population(rules);
            let set = xcs.matching_action_set(&percept("11"), action(0));
            xcs.update(&set, 0.0, 0.2);
            let absorbed = |rule: &&xcs::Classifier| rule.numerosity == 2;
            let subsumer = xcs.population().rules().iter().find(absorbed).unwrap();
            subsumer.condition.to_string()
        };
        let mut all: Vec<String> = (0..20).map(survivor).collect();
        all.sort();
        all.dedup();
        all
    };
    assert_eq!(survivors(SubsumerTies::First), ["1#"]);
    assert_eq!(survivors(SubsumerTies::Random), ["#1", "1#"]);
}

#[test]
fn xcs_is_paid_every_step_or_only_the_end() {
    let values = |xcs_payment| {
        let mut xcs = method(Method::Xcs, |setup| setup.reward.xcs_payment = xcs_payment);
        let way = [("00", BUMP), ("01", Outcome::ReachedGoal)];
        episode(&mut *xcs, &way, true);
        ["00", "01"].map(|bits| values(&*xcs, bits))
    };
    // -50 + 0.9 * 0; and the last step's -1 with the goal's 1000.
    let [bump, goal] = values(XcsPayment::All);
    assert_eq!(bump, -50.0);
    assert!((goal - 999.0).abs() < 1e-9, "{goal}");
    // 0 + 0.9 * 0; and Eq. 7 with two steps.
    assert_eq!(values(XcsPayment::Final), [0.0, 1000.5]);
}

#[test]
fn at_the_step_limit_xcs_learns_a_failure_or_nothing() {
    let values_after_a_failure = |xcs_step_limit| {
        let mut xcs = method(Method::Xcs, |setup| {
            setup.reward.xcs_step_limit = xcs_step_limit;
        });
        episode(&mut *xcs, &[("00", Outcome::Moved)], false);
        values(&*xcs, "00")
    };
    assert_eq!(values_after_a_failure(StepLimitUpdate::Failure), -1.0);
    assert_eq!(values_after_a_failure(StepLimitUpdate::Dropped), 0.0);
}

#[test]
fn a_failure_is_shared_out_like_a_success() {
    for (name, shares) in [
        (Method::AdaptedEven, [-50.0, -50.0]),
        (Method::AdaptedDiscounted, [-45.0, -50.0]),
    ] {
        for (failure, part) in [(-50.0, 1.0), (0.0, 0.0)] {
            let mut learner = method(name, |setup| setup.reward.failure = failure);
            let way = [("00", Outcome::Moved), ("01", Outcome::Moved)];
            episode(&mut *learner, &way, false);
            let found = ["00", "01"].map(|bits| values(&*learner, bits));
            assert_eq!(found, shares.map(|share| part * share), "{}", name.name());
        }
    }
}

#[test]
fn the_ga_runs_in_each_step_or_after_the_episode() {
    let rules_before_and_after_the_end = |stack_evolution| {
        let mut learner = method(Method::AdaptedEven, |setup| {
            setup.xcs.ga = true;
            (setup.xcs.theta_ga, setup.xcs.mu) = (0, 1.0);
            setup.reward.stack_evolution = stack_evolution;
        });
        for _ in 0..2 {
            take(&mut *learner, "0101", Outcome::Moved);
        }
        let before = learner.rule_count();
        learner.end_episode(false);
        (before > 2, learner.rule_count() > before)
    };
    let changes = rules_before_and_after_the_end;
    assert_eq!(changes(StackEvolution::AfterCredit), (false, true));
    assert_eq!(changes(StackEvolution::EachStep), (true, false));
}
