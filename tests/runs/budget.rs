//! No file but the picture of a map is larger for this program than its bytes say: bombs, files with holes, and what has no
//! end are refused, within ten times their size and 64 MiB.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

use crate::kit::program::ended;
use xcscr::record;

/// Runs the program with so much address space, in KiB.
fn within(kib: u64, args: &[&str]) -> Output {
    let limits = format!("ulimit -v {kib}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("sh");
    shell
        .args(["-c", &limits])
        .arg(env!("CARGO_BIN_EXE_xcscr"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(args);
    shell.output().unwrap()
}

/// What the program itself needs, threads and all, in KiB.
const ITSELF: u64 = 192 << 10;

#[test]
fn three_gigabytes_of_nothing_take_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let hole = folder.path().join("hole.mcap");
    File::create(&hole).unwrap().set_len(3 << 30).unwrap();
    let run = folder.path().join("run");
    fs::create_dir(&run).unwrap();
    fs::copy("worlds/maze4.json", run.join("world.json")).unwrap();
    for name in ["config.json", "rules.json", "checkpoint", "plan.json"] {
        fs::hard_link(&hole, run.join(name)).unwrap();
    }
    let (hole, run) = (hole.to_str().unwrap(), run.to_str().unwrap());
    let (out, world) = (folder.path().join("out"), "worlds/maze4.json");
    let out = out.to_str().unwrap();
    for args in [
        &["recording", "check", hole][..],
        &["recording", "info", hole],
        &["recording", "recover", hole, "-o", out],
        &["evaluate", hole, "--world", world],
        &["evaluate", run],
        &["train", hole],
        &["train", world, "--config", hole, "--out", out],
        &["train", world, "--init-rules", hole, "--out", out],
        &["train", world, "--init-rules", run, "--out", out],
        &["train", "--resume", run],
        &["study", "status", run],
        &["study", "run", hole, "--out", out],
    ] {
        let output = within(ITSELF + (64 << 10), args);
        let code = output.status.code().unwrap_or(-1);
        assert!([65, 74].contains(&code), "{args:?}: {output:?}");
        let (_, stderr) = ended(&output, code, &format!("{args:?}"));
        assert!(stderr.contains("larger than"), "{args:?}: {stderr}");
    }
}

#[test]
fn pipes_and_devices_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let out = folder.path().join("out");
    let (out, world) = (out.to_str().unwrap(), "worlds/maze4.json");
    let picture = format!("{out}.svg");
    for input in [pipe.to_str().unwrap(), "/dev/zero"] {
        for args in [
            &["recording", "check", input][..],
            &["recording", "info", input],
            &["recording", "recover", input, "-o", out],
            &["map", input, "-o", &picture],
            &["evaluate", input, "--world", world],
            &["world", "info", input],
            &["train", input, "--out", out],
            &["train", world, "--config", input, "--out", out],
            &["train", world, "--init-rules", input, "--out", out],
            &["study", "run", input, "--out", out],
        ] {
            // Nobody writes into the pipe: who opens it waits for ever.
            let limited = [&["timeout", "20"][..], &[env!("CARGO_BIN_EXE_xcscr")], args].concat();
            let mut command = Command::new(limited[0]);
            command
                .args(&limited[1..])
                .current_dir(env!("CARGO_MANIFEST_DIR"));
            let output = command.output().unwrap();
            let (_, stderr) = ended(&output, 74, &format!("{args:?}"));
            assert!(stderr.contains("not a regular file"), "{args:?}: {stderr}");
        }
    }
}

/// A small recording that unpacks to 60 MB in many chunks, of messages without content.
fn bomb(path: &Path) -> u64 {
    let options = mcap::WriteOptions::new()
        .chunk_size(Some(1 << 20))
        .emit_message_indexes(false);
    let mut writer = options.create(File::create(path).unwrap()).unwrap();
    let channel = writer.add_channel(0, "/x", "json", &Default::default());
    let header = mcap::records::MessageHeader {
        channel_id: channel.unwrap(),
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    let messages = 2_000_000;
    for _ in 0..messages {
        writer.write_to_known_channel(&header, &[]).unwrap();
    }
    writer.finish().unwrap();
    messages
}

#[test]
fn many_chunks_that_unpack_to_much_are_not_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (
        folder.path().join("bomb.mcap"),
        folder.path().join("out.mcap"),
    );
    let messages = bomb(&path);
    let size = fs::metadata(&path).unwrap().len();
    assert!(size < 100_000, "{size} bytes");
    let findings = record::check(&path).unwrap();
    assert!(
        findings[0].what.contains("its chunks unpack to"),
        "{findings:?}"
    );
    let recovery = record::recover(&path, &out, false).unwrap();
    // What is saved is within the half of what is believed, and what is not is named.
    let most = (200 * size + (16 << 20)) / 2 / 31;
    assert!(
        recovery.messages <= most && recovery.messages > 0,
        "{recovery:?}"
    );
    assert!(recovery.messages < messages / 4, "{recovery:?}");
    assert!(recovery.fault.unwrap().contains("unpacks to"));
    assert!(record::check(&out).is_ok());
    let args = [
        "recording",
        "recover",
        path.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--force",
    ];
    ended(&within(ITSELF + (64 << 10), &args), 3, "recover");
}

/// A recording of one message in the words of JSON, of as many bytes as are believed.
fn long_message(path: &Path) {
    let options = mcap::WriteOptions::new().chunk_size(Some(1 << 30));
    let mut writer = options.create(File::create(path).unwrap()).unwrap();
    let channel = writer.add_channel(0, "/step", "json", &Default::default());
    let header = mcap::records::MessageHeader {
        channel_id: channel.unwrap(),
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    let numbers = format!("[{}0]", "0,".repeat(7 << 20));
    writer
        .write_to_known_channel(&header, numbers.as_bytes())
        .unwrap();
    writer.finish().unwrap();
}

/// As a tree, fourteen megabytes of small numbers take four hundred.
#[test]
fn a_long_message_is_read_without_being_held_as_a_tree() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.mcap");
    long_message(&path);
    assert!(fs::metadata(&path).unwrap().len() < 100_000);
    let (file, out) = (path.to_str().unwrap(), folder.path().join("out.mcap"));
    for args in [
        &["recording", "check", file][..],
        &["recording", "info", file],
        &["recording", "verify", file],
        &["recording", "recover", file, "-o", out.to_str().unwrap()],
    ] {
        let output = within(ITSELF + (64 << 10), args);
        let code = output.status.code().unwrap_or(-1);
        assert!([0, 1, 3, 65].contains(&code), "{args:?}: {output:?}");
        ended(&output, code, &format!("{args:?}"));
    }
}

/// Messages that are no JSON, each before the one that was written first.
fn faulty(path: &Path) {
    let options = mcap::WriteOptions::new().chunk_size(Some(1 << 20));
    let mut writer = options.create(File::create(path).unwrap()).unwrap();
    let channel = writer.add_channel(0, "/tf", "json", &Default::default());
    let channel_id = channel.unwrap();
    for number in (0..300_000).rev() {
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time: number,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, b"{").unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn a_file_in_which_everything_is_wrong_is_told_in_a_thousand_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("faulty.mcap");
    faulty(&path);
    let findings = record::check(&path).unwrap();
    assert!(findings.len() < 1_100, "{} findings", findings.len());
    let told = |words: &str| findings.iter().any(|one| one.what.contains(words));
    assert!(told("does not match its schema") && told("comes after"));
    assert!(told("more faults than these"));
    let output = within(
        ITSELF + (64 << 10),
        &["recording", "check", path.to_str().unwrap()],
    );
    ended(&output, 65, "check");
}

/// Pixels of one grey, packed a thousand times smaller.
fn picture(path: &Path, side: u32) -> u64 {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    let pixels = vec![254; side as usize * side as usize];
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    fs::metadata(path).unwrap().len()
}

#[test]
fn a_picture_is_read_up_to_64_million_pixels_within_14_bytes_for_each() {
    let folder = tempfile::tempdir().unwrap();
    let (map, out) = (folder.path().join("m.yaml"), folder.path().join("w.json"));
    let header = "image: m.png\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n\
                  occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    fs::write(&map, header).unwrap();
    let files = ["world", "convert", map.to_str().unwrap()];
    let goal = [
        "-o",
        out.to_str().unwrap(),
        "--cell",
        "4",
        "--goal",
        "20,20",
    ];
    let args = [&files[..], &goal].concat();
    let size = picture(&folder.path().join("m.png"), 8192);
    assert!(size < 100_000, "{size} bytes");
    let (_, stderr) = ended(&within(ITSELF + (64 << 10), &args), 65, "convert");
    assert!(
        stderr.contains("8192 x 8192 pixels are more than 64000000"),
        "{stderr}"
    );
    // A map of 200 m at 5 cm, packed a thousand times smaller.
    picture(&folder.path().join("m.png"), 4096);
    let room = (14 << 24) >> 10;
    ended(&within(ITSELF + room, &args), 0, "convert");
}

#[test]
fn a_study_that_names_much_is_refused_before_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    let out = folder.path().join("out");
    let study = |worlds: &str, more: &str| {
        format!(
            "name = \"s\"\nworlds = [{worlds}]\nmethods = [\"xcs\"]\ntrials = 1\n\
             episodes = 1\n{more}"
        )
    };
    let many = |count: usize, name: &dyn Fn(usize) -> String| {
        let names = (0..count).map(|number| format!("{:?}", name(number)));
        names.collect::<Vec<String>>().join(",")
    };
    let rates: Vec<String> = (1..=2_501)
        .map(|n| format!("{}", f64::from(n) / 1e4))
        .collect();
    let sweep = format!("[sweep]\n\"xcs.beta\" = [{}]\n", rates.join(","));
    for (text, words) in [
        (
            study(&many(5, &|n| format!("dfs-1024-{n}")), ""),
            "cells of all generated worlds",
        ),
        (study(&many(1_001, &|n| format!("dfs-5-{n}")), ""), "worlds"),
        (study("\"maze4\"", &sweep), "2501 combinations"),
    ] {
        fs::write(&file, text).unwrap();
        let args = [
            "study",
            "run",
            file.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ];
        let (_, stderr) = ended(&within(ITSELF + (64 << 10), &args), 65, words);
        assert!(stderr.contains(words), "{words}: {stderr}");
        assert!(!out.exists(), "{words}: a folder was made");
    }
}

/// Nothing tells the cells apart, edges are joined, and episodes start in all: what can be believed
/// there is more than can be weighed.
#[test]
fn bounds_of_a_world_without_landmarks_are_unknown_and_take_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (world, out) = (folder.path().join("w.json"), folder.path().join("out"));
    let (world, out) = (world.to_str().unwrap(), out.to_str().unwrap());
    for side in [10, 100] {
        let mut rows = vec![".".repeat(side); side];
        rows[side / 2].replace_range(..1, "G");
        fs::write(world, format!(r#"{{"wrap": true, "rows": {rows:?}}}"#)).unwrap();
        let args = ["world", "info", world, "--bounds"];
        let (stdout, _) = ended(&within(ITSELF + (64 << 10), &args), 0, "info");
        assert!(stdout.contains("belief      unknown"), "{side}: {stdout}");
    }
    let args = [
        &["train", world, "--arena", "grid", "--method", "xcscr-plus"][..],
        &[
            "--set",
            "reward.step_threshold=50",
            "--episodes",
            "1",
            "--out",
            out,
        ],
    ]
    .concat();
    ended(&within(ITSELF + (64 << 10), &args), 0, "train");
}

/// What a world of 1024 x 1024 cells and all that is made of it may take. The largest has sixteen times
/// as many cells, and would take this test minutes without optimisation.
const LARGEST: u64 = 100 << 10;

#[test]
fn a_world_of_a_million_cells_is_trained_in_within_100_megabytes_and_too_large_a_one_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (world, out) = (folder.path().join("w.json"), folder.path().join("out"));
    let (world, out) = (world.to_str().unwrap(), out.to_str().unwrap());
    let hall = |side: usize| {
        let mut rows = vec![format!("#{}#", ".".repeat(side - 2)); side];
        rows[0] = "#".repeat(side);
        rows[side - 1] = rows[0].clone();
        rows[1].replace_range(1..2, "S");
        rows[side - 2].replace_range(side - 2..side - 1, "G");
        fs::write(world, format!(r#"{{"rows": {rows:?}}}"#)).unwrap();
    };
    hall(1024);
    let args = [
        &[
            "train",
            world,
            "--arena",
            "grid",
            "--episodes",
            "1",
            "--quiet",
        ][..],
        &["--set", "reward.step_threshold=100", "--out", out],
    ]
    .concat();
    let (_, stderr) = ended(&within(ITSELF + LARGEST, &args), 0, "train");
    assert!(
        stderr.contains("the longest shortest path has 2042"),
        "{stderr}"
    );
    // With as many steps as the maze asks for.
    let all = [&args[..args.len() - 4], &["--out", out, "--force"]].concat();
    ended(&within(ITSELF + LARGEST, &all), 0, "train");
    let highlights = folder.path().join("highlights.mcap");
    let told = [
        "recording",
        "highlights",
        out,
        "-o",
        highlights.to_str().unwrap(),
    ];
    let (_, stderr) = ended(
        &within(ITSELF + LARGEST, &told),
        65,
        "a highlights recording",
    );
    assert!(
        stderr.contains("too many cells for a highlights recording"),
        "{stderr}"
    );
    fs::write(world, format!(r#"{{"rows": {:?}}}"#, vec!["###"; 4097])).unwrap();
    let (_, stderr) = ended(
        &within(ITSELF + LARGEST, &["world", "info", world]),
        65,
        "info",
    );
    assert!(
        stderr.contains("at most 4096 columns and 4096 rows"),
        "{stderr}"
    );
}

/// Nothing tells its cells apart, and every episode is short: what is recorded repeats itself.
#[test]
fn recordings_of_a_hall_without_landmarks_are_believed() {
    let folder = tempfile::tempdir().unwrap();
    let (world, out) = (folder.path().join("w.json"), folder.path().join("out"));
    let mut rows = vec![".".repeat(32); 32];
    rows[31].replace_range(31.., "G");
    fs::write(
        &world,
        format!(r#"{{"wrap": true, "moves": 8, "rows": {rows:?}}}"#),
    )
    .unwrap();
    let args = [
        &[
            "train",
            world.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ][..],
        &[
            "--arena",
            "grid",
            "--method",
            "xcs",
            "--episodes",
            "60",
            "--quiet",
        ],
        &["--record", "last", "--set", "reward.step_threshold=1"],
    ]
    .concat();
    ended(&within(ITSELF + (256 << 10), &args), 0, "train");
    assert_eq!(record::check(&out.join("run.mcap")).unwrap(), []);
}

#[test]
fn memory_that_cannot_be_had_ends_in_code_74() {
    let folder = tempfile::tempdir().unwrap();
    let (study, out) = (folder.path().join("s.toml"), folder.path().join("out"));
    let text = "name = \"s\"\nworlds = [\"rooms-100-1\"]\nmethods = [\"dyna-q\"]\n\
                sensors = [\"position\"]\ntrials = 4\nepisodes = 2\n";
    fs::write(&study, text).unwrap();
    let (study, out) = (study.to_str().unwrap(), out.to_str().unwrap());
    let (mut refused, mut enough) = (0, 0);
    // With too little, the program itself cannot be loaded, and the system ends it.
    let is_loaded = |mib: &u64| within(mib << 10, &["--version"]).status.success();
    for mib in (32..160).step_by(16).filter(is_loaded) {
        let args = [
            "study", "run", study, "--out", out, "--jobs", "4", "--quiet",
        ];
        let output = within(mib << 10, &args);
        let (code, stderr) = (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr),
        );
        assert!(matches!(code, Some(0 | 74)), "{mib} MiB: {code:?} {stderr}");
        refused += usize::from(code == Some(74));
        enough += usize::from(code == Some(0));
        let _ = fs::remove_dir_all(out);
        // What is more than enough shows nothing new.
        if enough == 2 {
            break;
        }
    }
    assert!(refused > 0, "no limit was too little");
    assert!(enough > 0, "control: no limit was enough");
}
