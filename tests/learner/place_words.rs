//! Rules over a position read as ranges of columns and rows.

use std::fs;

use crate::kit::program::expect;

/// Does a text name a column or row by a pattern of bits?
fn has_pattern(text: &str) -> bool {
    ["column ", "row "].iter().any(|name| {
        text.split(name).skip(1).any(|rest| {
            let word: String = rest.chars().take_while(|c| "01#".contains(*c)).collect();
            word.contains('#') || word.len() > 2
        })
    })
}

#[test]
fn control_patterns_are_found() {
    assert!(has_pattern("if column ##1# then") && has_pattern("row 0110"));
    assert!(!has_pattern("column at most 3 or 10, row 11"));
}

#[test]
fn rules_over_a_position_are_told_as_ranges_by_rules_why_and_export() {
    let folder = tempfile::tempdir().unwrap();
    for (sensor, arena) in [
        ("position", "grid"),
        ("neighbours-position", "grid"),
        ("lidar-position", "physics"),
    ] {
        let run = folder.path().join(sensor);
        let run = run.to_str().unwrap();
        let choice = [
            "--sensor", sensor, "--arena", arena, "--method", "xcs", "--record", "none",
        ];
        let train = [
            "train",
            "worlds/maze4.json",
            "--episodes",
            "10",
            "--out",
            run,
        ];
        expect(0, &[&train[..], &choice].concat());
        let mut told = vec![
            expect(0, &["rules", run]).0,
            expect(0, &["rules", run, "--json"]).0,
            expect(0, &["rules", run, "--why", "1,1"]).0,
        ];
        // Of all rules, values may lie too close to be told apart in whole numbers.
        let few = format!("{run}-few.json");
        fs::write(&few, expect(0, &["rules", run, "--compact", "--json"]).0).unwrap();
        let export = [
            "export",
            &few,
            "--world",
            "worlds/maze4.json",
            "--sensor",
            sensor,
            "--target",
        ];
        for target in ["c99", "rust", "python", "dot", "csv", "json"] {
            told.push(expect(0, &[&export[..], &[target]].concat()).0);
        }
        for text in &told {
            assert!(!has_pattern(text), "{sensor}: {text}");
        }
        let [rules, _, why, ..] = &told[..] else {
            unreachable!()
        };
        for words in ["column at most 3", "row at least 4", "column 2 to 3"] {
            assert!(rules.contains(words), "{sensor}: {words}: {rules}");
        }
        assert!(why.contains("column 1, row 1"), "{sensor}: {why}");
    }
}
