use super::*;
use crate::layout::Layout;
use crate::signal::{Action, Percept};

/// Learns rules for percepts whose last bit tells whether any of the first two bits is set.
fn learned(induction: Induction) -> Population {
    let mut labelled_examples = LabelledExamples::default();
    for (number, percept) in ["000", "110", "011", "101"].iter().enumerate() {
        let mut best = crate::ByAction::default();
        best[usize::from(percept.ends_with('1'))] = true;
        let labelled_example = LabelledExample {
            percept: percept.parse().unwrap(),
            best,
            value: 5.0,
        };
        labelled_examples.give(number, labelled_example);
    }
    let mut population = Population::default();
    let mut induction = induction;
    induction.learn(&mut population, &mut labelled_examples, &Params::default());
    population
}

fn looks_at_the_last_bit(rule: &Classifier) -> bool {
    rule.condition.allele(2).is_some()
}

#[test]
fn a_rule_looks_at_a_later_part_only_where_the_earlier_does_not_suffice() {
    let in_one = learned(Induction::default());
    assert_eq!(in_one.len(), 2);
    assert!(in_one.rules().iter().all(looks_at_the_last_bit));

    let in_two = learned(Induction::in_parts(&[2], Record::LabelledExamples));
    assert_eq!(in_two.len(), 4);
    assert!(!in_two.rules().iter().any(looks_at_the_last_bit));

    // The first bit alone tells nothing, so the rules may use all others.
    let in_halves = learned(Induction::in_parts(&[1], Record::LabelledExamples));
    assert_eq!(in_halves.len(), 2);
    assert!(in_halves.rules().iter().all(looks_at_the_last_bit));
}

#[test]
fn statistics_come_from_the_examples_or_a_record_of_steps() {
    let figures = |rule: &Classifier| (rule.prediction, rule.experience, rule.fitness);
    let of_examples = learned(Induction::in_parts(&[1], Record::LabelledExamples));
    assert!(
        of_examples
            .rules()
            .iter()
            .all(|rule| figures(rule) == (5.0, 2, 2.0))
    );
    let of_steps = learned(Induction::in_parts(&[1], Record::Steps));
    assert!(
        of_steps
            .rules()
            .iter()
            .all(|rule| figures(rule) == (5.0, 0, 1.0))
    );
}
#[test]
fn a_rule_that_covers_no_example_keeps_its_figures() {
    let mut best = crate::ByAction::default();
    best[0] = true;
    let percept = "00".parse().unwrap();
    let value = -3.0;
    let mut labelled_examples = LabelledExamples::default();
    labelled_examples.give(
        0,
        LabelledExample {
            percept,
            best,
            value,
        },
    );
    let params = Params::default();
    let mut population = Population::default();
    let [inside, elsewhere] = ["0#", "11"].map(|condition| {
        let action = Action::new(0).unwrap();
        population.insert(Classifier {
            prediction: -7.0,
            ..Classifier::new(condition.parse().unwrap(), action, 0, &params)
        })
    });
    Induction::default().learn(&mut population, &mut labelled_examples, &params);
    let prediction = |id| population.get(id).map(|rule| rule.prediction);
    assert_eq!(prediction(inside), Some(value));
    assert_eq!(prediction(elsewhere), Some(-7.0));
}

#[test]
fn a_rule_that_covers_no_example_stays_when_something_else_is_learned() {
    let labelled_example = |percept: &str, action: usize| {
        let mut best = crate::ByAction::default();
        best[action] = true;
        LabelledExample {
            percept: percept.parse().unwrap(),
            best,
            value: 1.0,
        }
    };
    let (params, mut labelled_examples) = (Params::default(), LabelledExamples::default());
    let mut population = Population::default();
    let action = Action::new(0).unwrap();
    let elsewhere = Classifier::new("11".parse().unwrap(), action, 0, &params);
    let elsewhere = population.insert(elsewhere);
    let mut induction = Induction::default();
    for (number, percept) in ["00", "01"].into_iter().enumerate() {
        labelled_examples.give(number, labelled_example(percept, number));
        induction.learn(&mut population, &mut labelled_examples, &params);
        assert!(population.get(elsewhere).is_some(), "after {percept}");
        assert_eq!(
            population.len(),
            number + 2,
            "control: something is learned"
        );
    }
}

/// Returns rules for a number of four bits: action 1 is best from 3 to 9, action 0 elsewhere.
fn of_numbers(layout: Layout) -> Population {
    let mut labelled_examples = LabelledExamples::default();
    for number in 0..16_usize {
        let mut best = crate::ByAction::default();
        best[usize::from((3..=9).contains(&number))] = true;
        let labelled_example = LabelledExample {
            percept: format!("{number:04b}").parse().unwrap(),
            best,
            value: 1.0,
        };
        labelled_examples.give(number, labelled_example);
    }
    let mut labelled_examples = labelled_examples.with_layout(layout);
    let mut population = Population::default();
    Induction::default().learn(&mut population, &mut labelled_examples, &Params::default());
    population
}

#[test]
fn rules_over_a_number_are_ranges() {
    let conditions = |population: &Population| {
        let rules = population.rules().iter();
        let mut texts: Vec<_> = rules.map(|rule| rule.condition.to_string()).collect();
        texts.sort();
        texts
    };
    let layout = Layout::with_numbers([0..4, 4..4]).unwrap();
    let ranges = of_numbers(layout.clone());
    assert_eq!(conditions(&ranges), ["[0-2:4]", "[10-15:4]", "[3-9:4]"]);
    let bits = of_numbers(Layout::default());
    assert!(bits.len() > 3, "control: {:?}", conditions(&bits));

    let percepts: Vec<Percept> = (0..16)
        .map(|n| format!("{n:04b}").parse().unwrap())
        .collect();
    let values = |p: &Percept| bits.sums(p).array(2, false);
    let compacted = crate::compact(&bits, &layout, &percepts, values);
    assert_eq!(conditions(&compacted), ["[0-2:4]", "[10-15:4]", "[3-9:4]"]);
}

#[test]
fn a_layout_has_at_most_two_numbers_that_do_not_overlap() {
    assert!(Layout::with_numbers([2..4, 4..9]).is_some());
    assert_eq!(Layout::with_numbers([3..3, 3..3]), Some(Layout::default()));
    assert_eq!(Layout::with_numbers([2..4, 3..9]), None);
    assert_eq!(Layout::with_numbers([0..17, 17..18]), None);
    assert_eq!(Layout::with_numbers([0..1, 1..2, 2..3]), None);
}
