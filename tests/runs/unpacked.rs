//! Recordings and bags that unpack to far more than their size are refused before they fill the memory.

use std::fs::{self, File};
use std::path::Path;

use xcscr::record;

use super::budget::{ITSELF, SMALL, small, within};
use crate::kit::desk::Desk;
use crate::kit::program::ended;

/// Writes a recording of one JSON topic with these messages and their times, in chunks of this size.
fn write_recording<'a>(
    path: &Path,
    topic: &str,
    chunk_size: u64,
    messages: impl Iterator<Item = (u64, &'a [u8])>,
) -> u64 {
    let options = mcap::WriteOptions::new().chunk_size(Some(chunk_size));
    let options = options.emit_message_indexes(false);
    let mut writer = options.create(File::create(path).unwrap()).unwrap();
    let channel = writer.add_channel(0, topic, "json", &Default::default());
    let channel_id = channel.unwrap();
    for (log_time, data) in messages {
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    fs::metadata(path).unwrap().len()
}

#[test]
fn a_small_recording_that_unpacks_to_much_is_refused_before_it_fills_the_memory() {
    let desk = Desk::new();
    let zeros = vec![0; 400 << 20];
    let messages = [(0, &zeros[..])].into_iter();
    let size = write_recording(&desk.path("bomb.mcap"), "/zeros", 1 << 30, messages);
    assert!(size < 1 << 20, "{size} bytes");
    for (code, line) in [
        (65, "recording check @bomb.mcap"),
        (65, "recording info @bomb.mcap"),
    ] {
        ended(&within(&desk, 200 << 10, line), code, line);
    }
}

/// The last chunk is cut off, so that its size cannot be counted.
#[test]
fn a_recording_that_ends_within_a_chunk_is_refused_before_the_chunk_is_unpacked() {
    let desk = Desk::new();
    let zeros = vec![0; 400 << 20];
    let path = desk.path("cut.mcap");
    let size = write_recording(&path, "/scan", 1 << 30, [(0, &zeros[..])].into_iter());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..size as usize - 2000]).unwrap();
    desk.train("run", "maze4 --episodes 1 --record none");
    for line in [
        "recording check @cut.mcap",
        "recording info @cut.mcap",
        "drive @run --bag @cut.mcap",
    ] {
        ended(&within(&desk, 200 << 10, line), 65, line);
    }
}

/// Channels with many metadata, which a packed chunk repeats cheaply.
#[test]
fn channels_that_would_fill_the_memory_are_refused() {
    let desk = Desk::new();
    let path = desk.path("channels.mcap");
    let options = mcap::WriteOptions::new().repeat_channels(false);
    let mut writer = options.create(File::create(&path).unwrap()).unwrap();
    let entry = |number: u32| (format!("{number:08}"), String::new());
    let metadata = (0..50_000).map(entry).collect();
    for channel in 0..50 {
        let name = format!("/{channel}");
        writer.add_channel(0, &name, "json", &metadata).unwrap();
    }
    writer.finish().unwrap();
    ended(
        &within(&desk, 200 << 10, "recording info @channels.mcap"),
        65,
        "info",
    );
}

/// Commands to stand still, which pack well, take an entry each.
#[test]
fn a_bag_of_very_many_messages_is_refused() {
    let desk = Desk::new();
    let path = desk.path("bag.mcap");
    // A header of CDR and six numbers of eight bytes.
    let mut stop = [0; 4 + 6 * 8];
    stop[1] = 1;
    let messages = (0..1_000_000).map(|time| (time, &stop[..]));
    write_recording(&path, "/cmd_vel", 1 << 20, messages);
    desk.train("run", "maze4 --episodes 1 --record none");
    let line = "drive @run --bag @bag.mcap";
    let (_, stderr) = ended(&within(&desk, 400 << 10, line), 65, line);
    assert!(
        stderr.contains("its messages would take more than"),
        "{stderr}"
    );
}

/// One schema of 100 kB, and as many channels as there can be.
#[test]
fn a_schema_is_held_once_for_all_its_channels() {
    let desk = Desk::new();
    let path = desk.path("channels.mcap");
    let mut writer = mcap::WriteOptions::new()
        .create(File::create(&path).unwrap())
        .unwrap();
    let schema = writer.add_schema("x", "jsonschema", &vec![b' '; 100_000]);
    let schema = schema.unwrap();
    for channel in 0..65_000 {
        let name = format!("/{channel}");
        writer
            .add_channel(schema, &name, "json", &Default::default())
            .unwrap();
    }
    writer.finish().unwrap();
    let size = fs::metadata(&path).unwrap().len();
    let most = ITSELF + SMALL + ((10 * size) >> 10);
    for (code, line) in [
        (65, "recording check @channels.mcap"),
        (0, "recording info @channels.mcap"),
    ] {
        ended(&within(&desk, most, line), code, line);
    }
}

/// As a tree, fourteen megabytes of small numbers take four hundred.
#[test]
fn a_long_message_is_read_without_being_held_as_a_tree() {
    let desk = Desk::new();
    let numbers = format!("[{}0]", "0,".repeat(7 << 20));
    let messages = [(0, numbers.as_bytes())].into_iter();
    let size = write_recording(&desk.path("long.mcap"), "/step", 1 << 30, messages);
    assert!(size < 100_000, "{size} bytes");
    for line in [
        "recording check @long.mcap",
        "recording info @long.mcap",
        "recording verify @long.mcap",
    ] {
        let output = within(&desk, ITSELF + SMALL, line);
        let code = output.status.code().unwrap_or(-1);
        assert!([0, 1, 65].contains(&code), "{line}: {output:?}");
        ended(&output, code, line);
    }
}

/// Messages that are no JSON, each before the one that was written first.
#[test]
fn a_file_in_which_everything_is_wrong_is_told_in_a_thousand_lines() {
    let desk = Desk::new();
    let path = desk.path("faulty.mcap");
    let messages = (0..300_000)
        .rev()
        .map(|time_ns| (record::EPOCH_NS + time_ns, &b"{"[..]));
    write_recording(&path, "/tf", 1 << 20, messages);
    let findings = record::check(&path).unwrap();
    assert!(findings.len() < 1_100, "{} findings", findings.len());
    for words in ["comes after", "more faults than these"] {
        let told = findings.iter().any(|one| one.contains(words));
        assert!(told, "{words}");
    }
    small(&desk, 65, "recording check @faulty.mcap", "");
}
