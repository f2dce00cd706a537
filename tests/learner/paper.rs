//! The equations and algorithms of the paper on cases worked out by hand.
//!
//! Numbers marked (calc) were computed with a pocket calculator's value of Python, from the
//! equations as Butz and Wilson (2001) print them, not with this program.

use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept};
use xcscr::xcs::{Classifier, Params, Population, Xcs};

fn rule(condition: &str, action: usize) -> Classifier {
    let action = Action::new(action).unwrap();
    Classifier::new(condition.parse().unwrap(), action, 0, &Params::default())
}

fn learner(params: Params, actions: usize, rules: Vec<Classifier>) -> Xcs {
    let population = Population::try_from(rules).unwrap();
    Xcs::new(params, actions, Stream::new(1, StreamName::Evolution)).with_population(population)
}

fn percept(bits: &str) -> Percept {
    bits.parse().unwrap()
}

fn north() -> Action {
    Action::new(0).unwrap()
}

/// Two experienced rules that share an action set, and one beside it.
fn worked_rules() -> Vec<Classifier> {
    let experienced = |condition, action, prediction, error, fitness| Classifier {
        prediction,
        error,
        fitness,
        experience: 30,
        ..rule(condition, action)
    };
    vec![
        Classifier {
            set_size: 4.0,
            ..experienced("0", 0, 100.0, 20.0, 0.5)
        },
        Classifier {
            set_size: 6.0,
            numerosity: 2,
            ..experienced("#", 0, 300.0, 5.0, 0.25)
        },
        experienced("0", 1, -50.0, 0.0, 0.25),
    ]
}

fn no_subsumption() -> Params {
    Params {
        action_set_subsumption: false,
        ga_subsumption: false,
        ..Params::default()
    }
}

#[track_caller]
fn assert_close(measured: f64, expected: f64) {
    assert!(
        (measured - expected).abs() < 1e-9,
        "{measured} is not {expected}"
    );
}

#[test]
fn equation_6_weighs_by_fitness_and_as_printed_divides_by_that_of_the_whole_match_set() {
    // (100 * 0.5 + 300 * 0.25) / (0.5 + 0.25)
    for (value_over_match_set, expected) in [(false, [500.0 / 3.0, -50.0]), (true, [125.0, -12.5])]
    {
        let params = Params {
            value_over_match_set,
            ..no_subsumption()
        };
        let values = learner(params, 2, worked_rules()).values(&percept("0"));
        for (action, expected) in Action::all(2).zip(expected) {
            assert_close(values.get(action).unwrap(), expected);
        }
    }
}

#[test]
fn equations_1_to_5_update_an_action_set() {
    let mut xcs = learner(no_subsumption(), 2, worked_rules());
    let set = xcs.matching_action_set(&percept("0"), north());
    xcs.update(&set, 200.0, 0.2);
    let [a, b, other] = [0, 1, 2].map(|i| xcs.population().rules()[i]);
    assert_close(a.error, 36.0); // Eq. 2 with the old prediction: 20 + 0.2 (100 - 20)
    assert_close(a.prediction, 120.0); // Eq. 1: 100 + 0.2 (200 - 100)
    assert_close(a.set_size, 3.8); // 4 + 0.2 (3 - 4)
    assert_close(b.error, 24.0);
    assert_close(b.prediction, 280.0);
    assert_close(b.set_size, 5.4);
    assert_close(a.fitness, 0.412_355_212_355_212_3); // (calc)
    assert_close(b.fitness, 0.387_644_787_644_787_7); // (calc)
    assert_eq!((a.experience, b.experience), (31, 31));
    assert_eq!(
        other,
        worked_rules()[2],
        "a rule outside of [A] was touched"
    );
}

#[test]
fn equation_3_is_one_up_to_the_error_threshold_and_falls_by_the_fifth_power_beyond() {
    let params = Params::default();
    let accuracy = |error| {
        Classifier {
            error,
            ..rule("#", 0)
        }
        .accuracy(&params)
    };
    assert_eq!(accuracy(10.0), 1.0);
    assert_close(accuracy(20.0), 0.1 / 32.0);
    assert_close(accuracy(30.0), 0.1 / 243.0);
}

#[test]
fn a_young_rule_takes_the_mean_of_what_it_has_seen() {
    let mut xcs = learner(no_subsumption(), 1, vec![rule("0", 0)]);
    let set = xcs.matching_action_set(&percept("0"), north());
    for payoff in [30.0, 60.0, 90.0] {
        xcs.update(&set, payoff, 0.2);
    }
    assert_close(xcs.population().rules()[0].prediction, 60.0);
    xcs.update(&set, 0.0, 0.2);
    xcs.update(&set, 0.0, 0.2);
    assert_close(xcs.population().rules()[0].prediction, 36.0); // mean of five
    xcs.update(&set, 136.0, 0.2);
    assert_close(xcs.population().rules()[0].prediction, 56.0); // now at beta = 0.2
}

#[test]
fn the_most_general_accurate_rule_of_an_action_set_subsumes_the_others() {
    let accurate = |condition| Classifier {
        experience: 21,
        prediction: 5.0,
        ..rule(condition, 0)
    };
    let run = |rules| {
        let mut xcs = learner(Params::default(), 1, rules);
        let set = xcs.matching_action_set(&percept("000"), north());
        xcs.update(&set, 5.0, 0.2);
        let left = xcs
            .population()
            .rules()
            .iter()
            .map(|r| (r.condition.to_string(), r.numerosity));
        left.collect::<Vec<_>>()
    };
    let three = vec![accurate("000"), accurate("0##"), accurate("#00")];
    assert_eq!(run(three), [("#00".into(), 1), ("0##".into(), 2)]);
    // Control: without experience nothing is subsumed.
    assert_eq!(run(vec![rule("000", 0), rule("0##", 0)]).len(), 2);
}

#[test]
fn covering_gives_every_action_a_rule_that_matches() {
    let mut xcs = learner(Params::default(), 4, vec![]);
    let mut set = xcscr::xcs::MatchSet::default();
    xcs.form_match_set(&percept("0110"), &mut set);
    assert_eq!(set.micro(), 4);
    let rules = xcs.population().rules();
    assert!(
        rules.iter().all(|r| r.condition.matches(&percept("0110"))),
        "{rules:?}"
    );
    assert_eq!(xcs.values(&percept("0110")).as_slice(), [Some(0.0); 4]);
}

/// The number of micro-classifiers after each of some steps in one niche.
fn evolved(ga: bool, theta_ga: u32, steps: usize) -> Vec<u32> {
    let params = Params {
        ga,
        theta_ga,
        chi: 0.0,
        mu: 0.0,
        ..no_subsumption()
    };
    let mut xcs = learner(params, 1, vec![rule("0", 0)]);
    let mut set = xcscr::xcs::MatchSet::default();
    let mut step = |_| {
        xcs.form_match_set(&percept("0"), &mut set);
        xcs.evolve(&set.action_set(north()).unwrap());
        xcs.population().micro()
    };
    (0..steps).map(&mut step).collect()
}

#[test]
fn the_ga_waits_until_the_niche_has_rested_for_theta_ga_and_without_it_no_rule_is_made() {
    // Two copies when the time passes 0 + 3, and not again before it passes 4 + 3.
    assert_eq!(evolved(true, 3, 5), [1, 1, 1, 3, 3]);
    assert_eq!(evolved(false, 0, 100), [1; 100]);
}
