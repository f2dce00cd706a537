//! Hostile variants of valid files: of their bytes, and of the values in JSON documents. Values are
//! changed so that mutants reach what is behind the parser.

use serde_json::{Value, json};
use xcscr::xcs::random::Stream;

use super::chance::{dice, rounds};

/// Typical contents of hostile files.
const PIECES: [&[u8]; 16] = [
    b"-1",
    b"1e999",
    b"1e-320",
    b"NaN",
    b"null",
    b"{",
    b"[[[[",
    b"\"",
    b"\\u0000",
    b"\0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\r\n",
    b"99999999999999999999",
    b",",
    b"-0.0",
];

/// Changes a file in one to five places: flips a bit, replaces a byte, removes, doubles or inserts a
/// piece, or ends early.
pub fn bytes(valid: &[u8], dice: &mut Stream) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..=dice.below(4) {
        let at = dice.below(bytes.len() + 1);
        let to = (at + dice.below(20)).min(bytes.len());
        match dice.below(6) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..to)),
            2 => drop(bytes.splice(at..at, PIECES[dice.below(PIECES.len())].iter().copied())),
            3 => drop(bytes.splice(at..to, bytes[at..to].repeat(2))),
            4 if at < bytes.len() => bytes[at] = dice.bits() as u8,
            _ if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            _ => {}
        }
    }
    bytes
}

/// Returns a value that hardly any field accepts.
fn odd(dice: &mut Stream) -> Value {
    let odd = json!([
        null,
        true,
        false,
        0,
        1,
        -1,
        2,
        13,
        4294967295_u64,
        4294967296_u64,
        u64::MAX,
        i64::MIN,
        0.5,
        -0.0,
        1e308,
        5e-324,
        "",
        "\u{1b}[31mred",
        "0".repeat(70),
        [],
        {}
    ]);
    odd[dice.below(21)].clone()
}

/// Collects the paths to all values in a document.
fn paths(value: &Value, path: &mut Vec<usize>, all: &mut Vec<Vec<usize>>) {
    all.push(path.clone());
    let below: Vec<&Value> = match value {
        Value::Array(items) => items.iter().collect(),
        Value::Object(fields) => fields.values().collect(),
        _ => Vec::new(),
    };
    for (i, item) in below.into_iter().enumerate() {
        path.push(i);
        paths(item, path, all);
        path.pop();
    }
}

fn at<'a>(value: &'a mut Value, path: &[usize]) -> &'a mut Value {
    let Some((&first, rest)) = path.split_first() else {
        return value;
    };
    let below = match value {
        Value::Array(items) => items.get_mut(first),
        Value::Object(fields) => fields.values_mut().nth(first),
        _ => None,
    };
    at(below.expect("the path exists"), rest)
}

/// Changes one to three values of a document: to an odd value, to another value of the document, or by
/// one. Or removes or doubles an item.
pub fn values(valid: &Value, dice: &mut Stream) -> Value {
    let mut mutant = valid.clone();
    for _ in 0..=dice.below(3) {
        let mut all = Vec::new();
        paths(&mutant, &mut Vec::new(), &mut all);
        let other = at(&mut mutant.clone(), &all[dice.below(all.len())]).clone();
        let place = at(&mut mutant, &all[dice.below(all.len())]);
        match (dice.below(6), &mut *place) {
            (0, Value::Array(items)) if !items.is_empty() => drop(items.pop()),
            (1, Value::Array(items)) if !items.is_empty() => items.push(items[0].clone()),
            (0, Value::Object(fields)) => {
                let name = fields.keys().nth(dice.below(fields.len().max(1))).cloned();
                name.map(|name| fields.remove(&name));
            }
            (1 | 2, Value::Number(number)) => {
                let up = if dice.below(2) == 0 { 1.0 } else { -1.0 };
                *place = match (number.as_u64(), number.as_f64()) {
                    (Some(number), _) if up > 0.0 => json!(number.saturating_add(1)),
                    (Some(number), _) => json!(number.saturating_sub(1)),
                    (_, number) => json!(number.unwrap_or(0.0) + up),
                };
            }
            (3, _) => *place = other,
            _ => *place = odd(dice),
        }
    }
    mutant
}

/// Passes mutants of valid files to a reader, which returns true if it accepts one, in so many
/// [`rounds`]. Every second mutant of a JSON file has changed values. Some mutants must be
/// valid, or they would test nothing behind the parser.
#[track_caller]
pub fn feed(files: &[Vec<u8>], times: [usize; 3], mut reader: impl FnMut(&[u8]) -> bool) {
    let documents: Vec<Option<Value>> = files
        .iter()
        .map(|file| serde_json::from_slice(file).ok())
        .collect();
    let mut dice = dice(files.concat().len() as u64);
    let mut accepted = 0;
    for number in 0..rounds(times) {
        let file = number / 2 % files.len();
        let mutant = match &documents[file] {
            Some(document) if number % 2 == 0 => values(document, &mut dice).to_string().into(),
            _ => bytes(&files[file], &mut dice),
        };
        accepted += usize::from(reader(&mutant));
    }
    assert!(accepted > 0, "every mutant was refused");
}
