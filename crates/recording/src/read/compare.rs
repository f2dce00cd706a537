//! Comparison of two recordings.

use std::path::Path;

use super::reader::{Message, Recording};
use crate::error::Error;

/// Describes a difference at a time, in nanoseconds of simulation time; 0 outside of messages.
/// `topic` is the topic, or `attachment NAME` or `metadata` outside of messages.
fn difference(time_ns: u64, topic: &str, field: &str, [first, second]: [String; 2]) -> String {
    let seconds = time_ns as f64 / 1e9;
    format!("at {seconds} s, {topic}, {field}: {first} against {second}")
}

/// Compares two recordings: facts of the run first, then message by message, then the bytes.
/// Returns the first difference as text; `None` if the bytes are identical.
///
/// # Errors
/// If either recording is invalid.
pub fn compare(first: &[u8], second: &[u8]) -> Result<Option<String>, Error> {
    if first == second {
        return Ok(None);
    }
    let a = Recording::from_bytes(Path::new("the first"), first.to_vec())?;
    let b = Recording::from_bytes(Path::new("the second"), second.to_vec())?;
    if let Some(difference) = facts(&a, &b) {
        return Ok(Some(difference));
    }
    let found = messages(&a, &b)?;
    let same = first.iter().zip(second).take_while(|(x, y)| x == y).count();
    let rewritten = || {
        format!(
            "facts and messages are the same, but the files differ from byte {same} on: another program wrote one of them"
        )
    };
    Ok(found.or_else(|| Some(rewritten())))
}

fn facts(a: &Recording, b: &Recording) -> Option<String> {
    let both = [a, b];
    if a.metadata("run") != b.metadata("run") {
        let run = both.map(|one| format!("{:?}", one.metadata("run")));
        return Some(difference(0, "metadata", "run", run));
    }
    let names = both.map(|one| {
        let names = one.attachments().iter().map(|one| one.name.as_str());
        names.collect::<Vec<_>>().join(" ")
    });
    if names[0] != names[1] {
        return Some(difference(0, "attachments", "names", names));
    }
    let mut pairs = a.attachments().iter().zip(b.attachments());
    let (x, y) = pairs.find(|(x, y)| x != y)?;
    Some(bytes(
        0,
        &format!("attachment {}", x.name),
        &x.data,
        &y.data,
    ))
}

fn messages(a: &Recording, b: &Recording) -> Result<Option<String>, Error> {
    let (mut left, mut right) = (a.messages(), b.messages());
    loop {
        match (left.next().transpose()?, right.next().transpose()?) {
            (None, None) => return Ok(None),
            (Some(x), Some(y)) if x.time_ns == y.time_ns && x.topic() == y.topic() => {
                if x.data != y.data {
                    return Ok(Some(bytes(x.time_ns, x.topic(), &x.data, &y.data)));
                }
            }
            (x, y) => return Ok(Some(missing(x.as_ref(), y.as_ref()))),
        }
    }
}

/// Returns the difference if one recording lacks a message or has it at another time.
fn missing(x: Option<&Message>, y: Option<&Message>) -> String {
    let shown = [x, y].map(|one| match one {
        Some(message) => format!("{} at {} ns", message.topic(), message.time_ns),
        None => "the end".to_owned(),
    });
    let both = [x, y].into_iter().flatten();
    let earliest = both.min_by_key(|message| message.time_ns);
    let (time_ns, topic) = earliest.map_or((0, ""), |one| (one.time_ns, one.topic()));
    difference(time_ns, topic, "next message", shown)
}

fn bytes(time_ns: u64, topic: &str, a: &[u8], b: &[u8]) -> String {
    let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let shown = [a, b].map(|bytes| match bytes.get(same) {
        Some(byte) => format!("{byte:#04x}"),
        None => "the end".to_owned(),
    });
    difference(time_ns, topic, &format!("byte {same}"), shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_end_early_differ_at_their_end() {
        let found = bytes(7_000_000_000, "/tf", &[1, 2], &[1, 2, 3]);
        assert_eq!(found, "at 7 s, /tf, byte 2: the end against 0x03");
    }
}
