use proptest::prelude::*;

use super::*;

fn rule(condition: &str, numerosity: u32) -> Classifier {
    let params = Params::default();
    let action = Action::new(0).unwrap();
    Classifier {
        numerosity,
        ..Classifier::new(condition.parse().unwrap(), action, 0, &params)
    }
}

#[test]
fn a_twin_adds_its_numerosity() {
    let mut population = Population::default();
    let first = population.insert(rule("01#", 2));
    assert_eq!(population.insert(rule("01#", 3)), first);
    assert_eq!((population.len(), population.micro()), (1, 5));
    assert_eq!(population.get(first).unwrap().numerosity, 5);
}

#[test]
fn a_removed_rule_neither_matches_nor_blocks_a_twin() {
    let mut population = Population::default();
    let first = population.insert(rule("0##", 1));
    population.insert(rule("1##", 1));
    population.remove(first);
    let mut found = Vec::new();
    let percept = "000".parse().unwrap();
    population.for_each_match(&percept, |_, r| found.push(r.condition));
    assert!(found.is_empty(), "{found:?}");
    assert_ne!(population.insert(rule("0##", 1)), first);
}

#[test]
fn rules_that_contradict_each_other_are_refused_with_their_position() {
    let refuse = |rules: Vec<Classifier>| Population::try_from(rules).unwrap_err().to_string();
    assert_eq!(
        refuse(vec![rule("01", 1), rule("0", 1)]),
        "rule 2 (0) has a condition of another width than the first rule"
    );
    assert_eq!(
        refuse(vec![rule("01", 1), rule("01", 1)]),
        "rule 2 (01) is listed twice with the same action"
    );
    let broken = Classifier {
        prediction: f64::NAN,
        ..rule("01", 1)
    };
    assert!(refuse(vec![broken]).contains("not a number up to 1e100"));
    for set_size in [f64::NAN, 0.0, 1e7] {
        let broken = Classifier {
            set_size,
            ..rule("01", 1)
        };
        let fault = refuse(vec![broken]);
        assert!(fault.contains("set size"), "{set_size}: {fault}");
    }
    assert!(refuse(vec![rule("01", 0)]).contains("numerosity 0"));
}

proptest! {
    #[test]
    fn deletion_keeps_the_sum_of_numerosities_at_n(
        rules in prop::collection::vec(("[01#]{6}", 1_u32..9), 1..80), seed in any::<u64>(),
    ) {
        let params = Params { population_size: 32, ..Params::default() };
        let mut stream = Stream::new(seed, 0_u64);
        let mut population = Population::default();
        for (condition, numerosity) in &rules {
            population.insert(rule(condition, *numerosity));
            population.delete_surplus(&params, &mut stream);
            let sum: u32 = population.rules().iter().map(|r| r.numerosity).sum();
            prop_assert_eq!(sum, population.micro());
            prop_assert!(sum <= 32, "{} micro-classifiers", sum);
        }
    }

    #[test]
    fn a_population_survives_json_bit_for_bit(
        figures in prop::collection::vec((any::<f64>(), 1e-300_f64..1.0), 1..20),
    ) {
        let rules = figures.iter().enumerate().filter(|(_, (p, _))| p.abs() <= 1e100);
        let rules: Vec<Classifier> = rules
            .map(|(i, &(prediction, fitness))| Classifier {
                prediction,
                fitness,
                ..rule(&format!("{i:05b}"), 1)
            })
            .collect();
        let population = Population::try_from(rules).unwrap();
        let text = serde_json::to_string(&population).unwrap();
        let restored: Population = serde_json::from_str(&text).unwrap();
        for (a, b) in population.rules().iter().zip(restored.rules()) {
            prop_assert_eq!(a.prediction.to_bits(), b.prediction.to_bits());
            prop_assert_eq!(a.fitness.to_bits(), b.fitness.to_bits());
        }
        prop_assert_eq!(population, restored);
    }
}
