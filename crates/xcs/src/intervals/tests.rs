//! The expected numbers were worked out by hand.

use proptest::prelude::*;

use super::*;

fn condition(bounds: &[[f64; 2]]) -> Intervals {
    Intervals::new(bounds).unwrap()
}

fn percept(values: &[f64]) -> RealPercept {
    RealPercept::new(values).unwrap()
}

fn stream() -> Stream {
    Stream::new(1, 0_u64)
}

fn mutating(mu: f64) -> Params {
    Params {
        mu,
        ..Params::default()
    }
}

#[test]
fn an_interval_matches_between_its_bounds_and_at_them() {
    let rule = condition(&[[0.25, 0.5], [0.0, 1.0]]);
    let matched = [[0.25, 0.0], [0.5, 1.0], [0.24, 0.5], [0.51, 0.5]]
        .map(|values| rule.matches(&percept(&values)));
    assert_eq!(matched, [true, true, false, false]);
}

#[test]
fn values_outside_of_the_range_are_moved_into_it_and_nan_is_refused() {
    assert_eq!(
        percept(&[-0.5, 0.5, f64::INFINITY]).values(),
        [0.0, 0.5, 1.0]
    );
    let error = RealPercept::new(&[0.0, f64::NAN]).unwrap_err();
    assert_eq!(error.attribute, 1);
}

#[test]
fn invalid_bounds_are_refused() {
    for bounds in [
        [0.5, 0.4],
        [-0.1, 0.5],
        [0.5, 1.1],
        [f64::NAN, 0.5],
        [0.5, f64::NAN],
    ] {
        let error = Intervals::new(&[[0.0, 1.0], bounds]).unwrap_err();
        assert_eq!(error.attribute, 1, "{bounds:?}");
    }
}

#[test]
fn more_general_means_that_every_interval_contains_the_others() {
    let rule = condition(&[[0.25, 0.5], [0.5, 0.75]]);
    assert!(condition(&[[0.25, 0.5], [0.5, 0.8]]).is_more_general_than(&rule));
    assert!(!rule.is_more_general_than(&rule));
    assert!(!condition(&[[0.0, 1.0], [0.55, 1.0]]).is_more_general_than(&rule));
    assert!(!rule.is_more_general_than(&condition(&[[0.0, 1.0], [0.0, 1.0]])));
}

#[test]
fn specificity_is_the_sum_of_what_the_intervals_leave_out() {
    // 0.75 + 0.5 + 0.
    let rule = condition(&[[0.25, 0.5], [0.5, 1.0], [0.0, 1.0]]);
    assert_eq!(rule.specificity(), 1.25);
}

#[test]
fn crossover_exchanges_the_attributes_between_the_points() {
    let mut a = condition(&[[0.1, 0.2]; 4]);
    let mut b = condition(&[[0.3, 0.4]; 4]);
    a.exchange(&mut b, 1, 3);
    assert_eq!(a.bounds(), [[0.1, 0.2], [0.3, 0.4], [0.3, 0.4], [0.1, 0.2]]);
    assert_eq!(b.bounds(), [[0.3, 0.4], [0.1, 0.2], [0.1, 0.2], [0.3, 0.4]]);
}

#[test]
fn covering_draws_both_bounds_within_the_spread() {
    let settings = IntervalSettings {
        s0: 0.25,
        ..IntervalSettings::default()
    };
    let mut numbers = stream();
    let expected: Vec<[f64; 2]> = [0.5, 0.125]
        .iter()
        .map(|x| {
            let lower: f64 = x - 0.25 * numbers.unit();
            let upper: f64 = x + 0.25 * numbers.unit();
            [lower.max(0.0), upper]
        })
        .collect();
    let percept = percept(&[0.5, 0.125]);
    let cover = Intervals::covering(&percept, &Params::default(), &settings, &mut stream());
    assert_eq!(cover.bounds(), expected);
}

#[test]
fn mutation_moves_a_bound_by_at_most_m_and_no_other() {
    let settings = IntervalSettings::default();
    let at = percept(&[0.5; 1000]);
    let start = condition(&[[0.25, 0.75]; 1000]);
    let mut rule = start.clone();
    rule.mutate(&at, &mutating(0.2), &settings, &mut stream());
    let pairs = rule.bounds().as_flattened().iter();
    let moves: Vec<f64> = pairs
        .zip(start.bounds().as_flattened())
        .map(|(after, before)| after - before)
        .filter(|change| *change != 0.0)
        .collect();
    // 400 of 2000 bounds are expected, with a standard deviation of 18; half of them rise.
    assert!((330..470).contains(&moves.len()), "{}", moves.len());
    let rising = moves.iter().filter(|change| **change > 0.0).count();
    assert!((moves.len() / 3..moves.len() * 2 / 3).contains(&rising));
    assert!(moves.iter().all(|change| change.abs() <= 0.1));
    rule.mutate(&at, &mutating(0.0), &settings, &mut stream());
    assert_eq!(
        moves.len(),
        2000 - unchanged(&rule, &start),
        "mu = 0 moves none"
    );
}

fn unchanged(a: &Intervals, b: &Intervals) -> usize {
    let pairs = a
        .bounds()
        .as_flattened()
        .iter()
        .zip(b.bounds().as_flattened());
    pairs.filter(|(a, b)| a == b).count()
}

#[test]
fn conditions_print_with_two_decimals_and_a_hash_for_a_dont_care() {
    let rule = condition(&[[0.25, 0.5], [0.0, 1.0], [0.0, 0.126]]);
    assert_eq!(rule.to_string(), "[0.25, 0.50] # [0.00, 0.13]");
}

#[test]
fn a_condition_is_read_as_it_was_written_and_an_invalid_one_is_refused() {
    let rule = condition(&[[0.1, 0.30000000000000004], [0.0, 1.0]]);
    let text = serde_json::to_string(&rule).unwrap();
    assert_eq!(text, "[[0.1,0.30000000000000004],[0.0,1.0]]");
    assert_eq!(serde_json::from_str::<Intervals>(&text).unwrap(), rule);
    assert!(serde_json::from_str::<Intervals>("[[0.3,0.1]]").is_err());
}

proptest! {
    #[test]
    fn operators_keep_the_bounds_ordered_and_in_the_range(
        values in prop::collection::vec(0.0_f64..=1.0, 1..9), seed in any::<u64>(),
        from in 0_usize..9, to in 0_usize..9, m in 0.0_f64..=1.0, s0 in 0.0_f64..=2.0,
    ) {
        let (percept, settings) = (percept(&values), IntervalSettings { s0, m });
        let (params, mut stream) = (mutating(0.5), Stream::new(seed, 0_u64));
        let mut cover = || Intervals::covering(&percept, &params, &settings, &mut stream);
        let (mut a, mut b) = (cover(), cover());
        prop_assert!(a.matches(&percept) && b.matches(&percept));
        a.exchange(&mut b, from, to);
        prop_assert!(a.matches(&percept) && b.matches(&percept));
        a.mutate(&percept, &params, &settings, &mut stream);
        prop_assert_eq!(Intervals::new(a.bounds()).unwrap(), a);
    }

    #[test]
    fn the_index_finds_what_matching_each_rule_finds(
        bounds in prop::collection::vec([0.0_f64..=1.0, 0.0..=1.0, 0.0..=1.0, 0.0..=1.0], 0..60),
        removed in prop::collection::vec(any::<prop::sample::Index>(), 0..30),
        values in [0.0_f64..=1.0, 0.0..=1.0],
    ) {
        let ordered = |a: f64, b: f64| [a.min(b), a.max(b)];
        let rule = |[a, b, c, d]: [f64; 4]| condition(&[ordered(a, b), ordered(c, d)]);
        let mut rules: Vec<Intervals> = bounds.into_iter().map(rule).collect();
        let mut index = IntervalIndex::default();
        rules.iter().for_each(|rule| index.push(rule));
        for position in removed {
            if !rules.is_empty() {
                let position = position.index(rules.len());
                rules.swap_remove(position);
                index.swap_remove(position);
            }
        }
        let (percept, mut found) = (percept(&values), Vec::new());
        index.for_each_match(&percept, |position| found.push(position));
        let expected: Vec<usize> =
            (0..rules.len()).filter(|&at| rules[at].matches(&percept)).collect();
        prop_assert_eq!(found, expected);
    }
}
