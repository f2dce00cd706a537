//! `--live`, as a viewer sees it: built with `cargo test --features live` only.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::Child;

use crate::PHYSICS;
use crate::kit::desk::Desk;
use crate::kit::folder::assert_same;
use crate::kit::messages::{Raw, raw};
use crate::kit::program::{signal, wait_until};
use crate::kit::served::LONG;
use serde_json::{Value, json};
use xcscr::record::reader::Recording;

const SAMPLE: &str = "recordings/sample-maze4.mcap";
/// A training that would take four days if it was watched to its end.
const SLOW: &str = "train maze4 --quiet --out @run --speed 0.01";

/// The program with `--live` and any port that is free; killed at the latest when the test ends.
struct Live {
    child: Child,
    port: u16,
}

impl Live {
    fn new(desk: &Desk, line: &str) -> Self {
        let mut child = desk.spawn(&format!("{line} --live --port 0"));
        let mut line = String::new();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        stderr.read_line(&mut line).unwrap();
        let address = line.split("ws://127.0.0.1:").nth(1);
        let address = address.unwrap_or_else(|| panic!("{line}"));
        let port = address.split(':').next().unwrap().parse().unwrap();
        Self { child, port }
    }

    /// Replays the sample, with these options.
    fn sample(more: &str) -> Self {
        Self::new(&Desk::new(), &format!("replay {SAMPLE} {more}"))
    }

    fn code(&mut self) -> Option<i32> {
        self.child.wait().unwrap().code()
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A viewer that speaks as much of WebSocket as it needs.
struct Viewer {
    stream: BufReader<TcpStream>,
    /// By number: the topics that it listens to.
    topics: HashMap<u64, String>,
}

impl Viewer {
    /// Connects and listens to one topic, or to all.
    fn new(live: &Live, topic: Option<&str>) -> Self {
        let host = format!("Host: localhost:{}", live.port);
        let (line, mut viewer) = Self::knock(live, &host);
        assert!(line.starts_with("HTTP/1.1 101"), "{line}");
        viewer.subscribe(topic);
        viewer
    }

    /// Asks to be let in, with these headers; gives the first line of the answer.
    fn knock(live: &Live, headers: &str) -> (String, Self) {
        let mut stream = TcpStream::connect(("127.0.0.1", live.port)).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        let upgrade = "Upgrade: websocket\r\nConnection: Upgrade\r\n\
                       Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\
                       Sec-WebSocket-Version: 13\r\n\
                       Sec-WebSocket-Protocol: foxglove.sdk.v1";
        let head = format!("GET / HTTP/1.1\r\n{headers}\r\n{upgrade}\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        let mut stream = BufReader::new(stream);
        let (mut first, mut line) = (String::new(), String::new());
        stream.read_line(&mut first).unwrap();
        while stream.read_line(&mut line).unwrap() > 2 {
            line.clear();
        }
        let topics = HashMap::new();
        (first, Self { stream, topics })
    }

    fn subscribe(&mut self, topic: Option<&str>) {
        let advertised = loop {
            let (_, data) = self.frame().unwrap();
            let said: Value = serde_json::from_slice(&data).unwrap_or_default();
            if said["op"] == "advertise" {
                break said;
            }
        };
        for channel in advertised["channels"].as_array().unwrap() {
            let name = channel["topic"].as_str().unwrap();
            if topic.is_none_or(|topic| topic == name) {
                let id = channel["id"].as_u64().unwrap();
                self.topics.insert(id, name.to_owned());
            }
        }
        let ids = self.topics.keys();
        let wanted: Vec<_> = ids.map(|id| json!({"id": id, "channelId": id})).collect();
        self.say(&json!({"op": "subscribe", "subscriptions": wanted}).to_string());
    }

    /// Sends a text, masked with zeros.
    fn say(&mut self, text: &str) {
        let length = u16::try_from(text.len()).unwrap().to_be_bytes();
        let mut frame = vec![0x81, 0x80 | 126, length[0], length[1], 0, 0, 0, 0];
        frame.extend_from_slice(text.as_bytes());
        self.stream.get_mut().write_all(&frame).unwrap();
    }

    /// Kind and content of the next frame; `None` at the end.
    fn frame(&mut self) -> Option<(u8, Vec<u8>)> {
        let [kind, short] = self.bytes()?;
        let length = match short {
            126 => u16::from_be_bytes(self.bytes()?).into(),
            127 => u64::from_be_bytes(self.bytes()?),
            short => short.into(),
        };
        let mut data = vec![0; usize::try_from(length).unwrap()];
        self.stream.read_exact(&mut data).ok()?;
        Some((kind & 0xf, data))
    }

    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        self.stream.read_exact(&mut bytes).ok()?;
        Some(bytes)
    }

    /// The next message that was recorded; `None` at the end.
    fn next(&mut self) -> Option<Raw> {
        loop {
            let (kind, data) = self.frame()?;
            if kind == 2 && data[0] == 1 {
                let id = u32::from_le_bytes(data[1..5].try_into().unwrap());
                let time_ns = u64::from_le_bytes(data[5..13].try_into().unwrap());
                let topic = self.topics[&u64::from(id)].clone();
                return Some((topic, time_ns, data[13..].to_vec()));
            }
        }
    }

    fn wait_for(&mut self, topic: &str) -> Raw {
        loop {
            let said = self.next().unwrap_or_else(|| panic!("no {topic}"));
            if said.0 == topic {
                return said;
            }
        }
    }
}

fn sample() -> Vec<Raw> {
    raw(&Recording::open(Path::new(SAMPLE)).unwrap())
}

#[test]
fn a_replay_streams_what_the_file_says_byte_for_byte_and_ends_when_the_viewer_goes() {
    let mut live = Live::sample("--speed 1000");
    let mut viewer = Viewer::new(&live, None);
    for (number, wanted) in sample().into_iter().enumerate() {
        let found = viewer.next().unwrap();
        let (topic, time_ns) = (&wanted.0, wanted.1);
        assert!(found == wanted, "{number}: {topic} at {time_ns} ns");
    }
    drop(viewer);
    assert_eq!(live.code(), Some(0));
}

#[test]
fn who_comes_late_still_sees_the_maze_and_the_robot_at_once() {
    let live = Live::sample("");
    let mut first = Viewer::new(&live, Some("/step"));
    first.wait_for("/step");
    first.wait_for("/step");
    for topic in ["/scene/maze", "/scene/robot", "/scene/policy"] {
        let found = Viewer::new(&live, Some(topic)).next().unwrap();
        let wanted = sample().into_iter().find(|said| said.0 == topic).unwrap();
        assert!(found == wanted, "{topic}");
    }
}

#[test]
fn a_run_that_is_watched_gives_the_same_files_and_the_viewer_sees_them() {
    let desk = Desk::new();
    let plain = desk.train("plain", PHYSICS);
    let line = format!("train {PHYSICS} --quiet --out @watched --speed 10000");
    let mut live = Live::new(&desk, &line);
    let mut viewer = Viewer::new(&live, None);
    let seen: Vec<Raw> = std::iter::from_fn(|| viewer.next()).collect();
    assert_eq!(live.code(), Some(0));
    assert_same(&desk.path("watched"), &plain, "watched");
    let episodes = (1..=5).map(|number| format!("plain/ep-000{number}.mcap"));
    let recorded: Vec<Raw> = episodes
        .flat_map(|file| raw(&desk.recording(&file)))
        .collect();
    assert!(seen == recorded);
}

#[test]
fn when_the_viewer_goes_training_runs_as_fast_as_it_can() {
    let desk = Desk::new();
    let mut live = Live::new(&desk, &format!("{SLOW} --record none"));
    Viewer::new(&live, Some("/tf")).next().unwrap();
    let ended = || live.child.try_wait().unwrap().is_some();
    wait_until("the end of the training", ended);
    assert_eq!(live.code(), Some(0));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_replay_that_waits_and_a_training_that_is_watched() {
    let mut replay = Live::sample("");
    signal(&replay.child, "INT");
    assert_eq!(replay.code(), Some(0));
    let desk = Desk::new();
    let mut live = Live::new(&desk, SLOW);
    let mut viewer = Viewer::new(&live, None);
    viewer.wait_for("/rule");
    signal(&live.child, "INT");
    assert_eq!(live.code(), Some(75), "interrupted, with a checkpoint");
}

#[test]
fn a_port_that_is_taken_is_an_error_with_the_way_out() {
    let live = Live::sample("");
    let line = format!("replay {SAMPLE} --live --port {}", live.port);
    Desk::new().fails(74, &line, "choose another `--port`");
}

#[test]
fn only_viewers_that_are_allowed_are_let_in() {
    let live = Live::sample("--allow-origin https://viewer.example");
    let port = live.port;
    let status = |headers: &str| {
        let (line, _) = Viewer::knock(&live, headers);
        line.split(' ').nth(1).unwrap_or_default().to_owned()
    };
    let own = format!("Host: 127.0.0.1:{port}");
    assert_eq!(status(&own), "101");
    for good in [
        "https://app.foxglove.dev",
        "https://lichtblick-suite.github.io",
        "https://viewer.example",
        "file://",
    ] {
        assert_eq!(status(&format!("{own}\r\nOrigin: {good}")), "101", "{good}");
    }
    for bad in ["https://evil.example", "null", "http://localhost:8080"] {
        assert_eq!(status(&format!("{own}\r\nOrigin: {bad}")), "403", "{bad}");
    }
    let rebound = format!("Host: evil.example:{port}");
    assert_eq!(status(&rebound), "421");
    assert_eq!(status("X-None: 1"), "400");
}

#[test]
fn silent_connections_keep_no_viewer_out() {
    let live = Live::sample("");
    let connect = || TcpStream::connect(("127.0.0.1", live.port)).unwrap();
    let _silent: Vec<TcpStream> = (0..100).map(|_| connect()).collect();
    let host = format!("Host: 127.0.0.1:{}", live.port);
    let is_let_in = || Viewer::knock(&live, &host).0.starts_with("HTTP/1.1 101");
    wait_until("a viewer is let in", is_let_in);
}

/// Training sends some hundred times what the buffers between the two hold.
#[test]
fn a_viewer_that_reads_nothing_slows_no_training_down() {
    let desk = Desk::new();
    let line = "train maze4 --quiet --record none --out @run --speed 10000";
    let mut live = Live::new(&desk, line);
    let _deaf = Viewer::new(&live, None);
    assert_eq!(live.code(), Some(0));
}
