//! Tests of the deletion votes.

use super::*;
use crate::action::Action;

fn rule(set_size: f64, fitness: f64, numerosity: u32, experience: u32) -> Classifier {
    let params = Params::default();
    let action = Action::new(0).unwrap();
    Classifier {
        set_size,
        fitness,
        numerosity,
        experience,
        ..Classifier::new("#".parse().unwrap(), action, 0, &params)
    }
}

/// The roulette as Butz and Wilson describe it, over every rule.
fn plain_roulette(rules: &[Classifier], params: &Params, ball: f64) -> usize {
    let micro: u32 = rules.iter().map(|r| r.numerosity).sum();
    let mean = rules.iter().map(|r| r.fitness).sum::<f64>() / f64::from(micro);
    let vote = |r: &Classifier| {
        let own = r.fitness / f64::from(r.numerosity);
        let vote = r.set_size * f64::from(r.numerosity);
        let vote = vote * f64::from(r.eam);
        if r.experience > 20 && own < params.delta * mean {
            vote * mean / own
        } else {
            vote
        }
    };
    let mut left = ball * rules.iter().map(vote).sum::<f64>();
    let stops = |r: &Classifier| {
        left -= vote(r);
        left < 0.0
    };
    rules.iter().position(stops).unwrap_or(rules.len() - 1)
}

#[test]
fn an_experienced_rule_of_low_fitness_is_more_likely_to_be_deleted() {
    // Mean fitness (0.999 + 0.001) / 2 = 0.5, cut 0.05. Votes: 10, and 10 * 0.5 / 0.001 = 5000.
    let rules = [rule(10.0, 0.999, 1, 21), rule(10.0, 0.001, 1, 21)];
    let mut votes = DeletionVotes::default();
    (0..2).for_each(|position| votes.touch(position));
    let mut at = |ball| votes.roulette(&rules, 2, &Params::default(), ball);
    assert_eq!([at(0.0), at(9.9 / 5010.0), at(10.1 / 5010.0)], [0, 0, 1]);
}

#[test]
fn a_young_rule_of_low_fitness_is_spared() {
    let rules = [rule(10.0, 0.999, 1, 21), rule(10.0, 0.001, 1, 20)];
    let mut votes = DeletionVotes::default();
    (0..2).for_each(|position| votes.touch(position));
    let mut at = |ball| votes.roulette(&rules, 2, &Params::default(), ball);
    assert_eq!([at(0.49), at(0.51)], [0, 1]);
}

#[test]
fn a_rule_with_a_large_eam_is_more_likely_to_be_deleted() {
    let mut rules = [rule(10.0, 0.5, 1, 21), rule(10.0, 0.5, 1, 21)];
    let at = |rules: &[Classifier], ball| {
        let mut votes = DeletionVotes::default();
        (0..2).for_each(|position| votes.touch(position));
        votes.roulette(rules, 2, &Params::default(), ball)
    };
    assert_eq!(
        [0.49, 0.51].map(|ball| at(&rules, ball)),
        [0, 1],
        "eam 1 and 1"
    );
    // Votes: 10, and 10 * 4.
    rules[1].eam = 4.0;
    assert_eq!(
        [0.19, 0.21].map(|ball| at(&rules, ball)),
        [0, 1],
        "eam 1 and 4"
    );
}

#[test]
fn rules_of_extreme_fitness_share_the_deletions() {
    use crate::random::Stream;
    for fitness in [0.0, f64::MIN_POSITIVE, 1e-300] {
        let mut rules: Vec<_> = (0..10).map(|_| rule(10.0, fitness, 1, 21)).collect();
        rules.push(rule(10.0, 1.0, 1, 21));
        let mut votes = DeletionVotes::default();
        (0..rules.len()).for_each(|position| votes.touch(position));
        let mut stream = Stream::new(1, 0_u64);
        let mut found = [0; 11];
        for _ in 0..1_000 {
            found[votes.roulette(&rules, 11, &Params::default(), stream.unit())] += 1;
        }
        assert!(
            found[..10].iter().all(|count| (50..200).contains(count)),
            "{fitness}: {found:?}"
        );
        assert_eq!(found[10], 0, "{fitness}: the fit rule stays");
    }
}

#[test]
fn the_cached_roulette_stops_where_the_plain_one_does() {
    use crate::random::Stream;
    let mut stream = Stream::new(7, 0_u64);
    let params = Params::default();
    let random_rule = |s: &mut Stream| Classifier {
        eam: 1.0 + 3.0 * s.unit() as f32,
        ..rule(
            1.0 + 50.0 * s.unit(),
            s.unit().powi(6) + 1e-9,
            1 + s.below(4) as u32,
            s.below(60) as u32,
        )
    };
    let mut rules: Vec<_> = (0..300).map(|_| random_rule(&mut stream)).collect();
    let mut votes = DeletionVotes::default();
    (0..300).for_each(|i| votes.touch(i));
    for round in 0..5_000 {
        let changed = stream.below(300);
        rules[changed] = random_rule(&mut stream);
        votes.touch(changed);
        let micro = rules.iter().map(|r| r.numerosity).sum();
        let ball = stream.unit();
        assert_eq!(
            votes.roulette(&rules, micro, &params, ball),
            plain_roulette(&rules, &params, ball),
            "round {round}, ball {ball}"
        );
    }
}
