//! Policies that cannot be expressed exactly are not exported.

use super::exporting::Learned;
use xcscr::agent::{Knowledge, Method};
use xcscr::export::{ExportError, QuantisedPolicy};
use xcscr::sensor::Sensor;

#[test]
fn an_empty_table_is_refused() {
    let nothing = Knowledge::Table(Default::default());
    assert_eq!(
        QuantisedPolicy::new(&nothing, 16, 4, &[]).unwrap_err(),
        ExportError::Empty
    );
}

/// What was learned as so many rules for the first action, all of which match the percept of zeros, and one
/// for each of two others, one of them better by `ahead`.
fn close_rules(many: usize, ahead: f64) -> Learned {
    let mut learned = Learned::new("maze4", Method::Xcscr, Sensor::Neighbours);
    let rule = |condition: &str, action: u8, prediction: f64| {
        format!(
            r#"{{"condition":"{condition}","action":{action},"prediction":{prediction:?},
            "error":0.0,"fitness":1.0,"numerosity":1,"experience":1,"time_stamp":0,"set_size":1.0}}"#
        )
    };
    // The zeros of a number, and don't-cares for its ones.
    let of_number = |number: usize| format!("{number:016b}").replace('1', "#");
    let any = "#".repeat(16);
    let mut rules: Vec<String> = (0..many)
        .map(|one| rule(&of_number(one), 0, 1000.0))
        .collect();
    rules.extend([rule(&any, 1, 1000.0 + ahead), rule(&any, 2, 0.0)]);
    let json = format!(r#"{{"rules":[{}]}}"#, rules.join(","));
    learned.knowledge = serde_json::from_str(&json).unwrap();
    learned
}

#[test]
fn worths_too_close_for_whole_numbers_are_refused() {
    let next = f64::from_bits(1000_f64.to_bits() + 1);
    let refused = close_rules(1, next - 1000.0).policy().unwrap_err();
    assert!(matches!(refused, ExportError::Close(_)), "{refused}");
}

#[test]
fn votes_whose_sums_do_not_fit_are_refused_and_never_added_up() {
    let ahead = 1e-4;
    assert!(
        close_rules(200, ahead).policy().is_ok(),
        "control: fewer rules"
    );
    let refused = close_rules(300, ahead).policy().unwrap_err();
    assert_eq!(refused, ExportError::Sums(302));
    assert!(refused.to_string().contains("--compact"), "{refused}");
    assert!(
        close_rules(300, 1.0).policy().is_ok(),
        "control: votes of 16 bits"
    );
}
