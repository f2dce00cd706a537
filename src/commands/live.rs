//! `--live`: streams to a viewer.

use std::thread;
use std::time::{Duration, Instant};

use xcscr::ErrorKind;
#[cfg(feature = "live")]
use xcscr::record::live::Stream;
use xcscr::record::server::Origin;
use xcscr::record::{Tap, Topic};

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::terminal::say;

/// The default port of viewers.
pub const LIVE_PORT: u16 = 8765;
/// Interval at which the stream polls for viewers and interrupts.
const TICK: Duration = Duration::from_millis(100);
/// How long training waits for a viewer: long enough to open one, and short enough for scripts.
const VIEWER_WAIT: Duration = Duration::from_secs(60);

/// Arguments of commands that can stream.
#[derive(Debug, clap::Args)]
pub struct LiveArgs {
    /// Stream to a viewer on this machine (needs a build with `--features live`). The replay waits
    /// for a viewer and pauses while there is none. Pages of Foxglove and Lichtblick may connect;
    /// `--allow-origin` adds those of another viewer.
    #[arg(long)]
    live: bool,
    /// Speed of the stream relative to real time [default: 1].
    #[arg(long, value_name = "X", requires = "live", value_parser = speed)]
    speed: Option<f64>,
    /// Also let pages of this origin read the served or streamed data, such as
    /// https://viewer.example.
    #[arg(long, value_name = "ORIGIN")]
    pub allow_origin: Vec<Origin>,
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(speed) if (0.01..=10_000.0).contains(&speed) => Ok(speed),
        _ => Err("must be from 0.01 to 10000".to_owned()),
    }
}

impl LiveArgs {
    /// Opens the broadcast if requested, and prints on stderr how to watch it.
    pub fn open(&self, port: u16, usual_speed: f64) -> Result<Option<Broadcast>, Failure> {
        if !self.live {
            return Ok(None);
        }
        let broadcast = Broadcast {
            stream: open(port, &self.allow_origin)?,
            speed: self.speed.unwrap_or(usual_speed),
            since: None,
            interrupt: Interrupt::notice()?,
        };
        let url = broadcast.stream.url();
        say(&format!(
            "Live on {url}: choose \"Open connection\" in Foxglove or Lichtblick; Ctrl-C ends it."
        ));
        Ok(Some(broadcast))
    }
}

/// A stream whose simulated time keeps to a multiple of real time while a viewer is connected.
pub struct Broadcast {
    stream: Stream,
    speed: f64,
    /// The time at which a viewer connected: real time, and simulated time in nanoseconds.
    since: Option<(Instant, u64)>,
    interrupt: Interrupt,
}

impl Broadcast {
    /// Waits for a viewer, at most for `most`. Ctrl-C also ends the wait.
    pub fn wait_for_viewer(&self, most: Duration) {
        if self.stream.is_watched() {
            return;
        }
        let begun = Instant::now();
        while !self.stream.is_watched() && !self.is_interrupted() && begun.elapsed() < most {
            thread::sleep(TICK);
        }
        // A viewer subscribes to its topics one by one.
        thread::sleep(TICK);
    }

    /// Waits for a viewer, then returns a function that sends each recorded message.
    pub fn into_tap(mut self) -> Tap {
        self.wait_for_viewer(VIEWER_WAIT);
        Box::new(move |topic, time_ns, data: &[u8]| self.send(topic, time_ns, data))
    }

    /// Waits until a message is due, then sends it.
    pub fn send(&mut self, topic: Topic, time_ns: u64, data: &[u8]) {
        self.keep_pace(time_ns);
        self.stream.send(topic, time_ns, data);
    }

    fn keep_pace(&mut self, time_ns: u64) {
        if !self.stream.is_watched() {
            self.since = None;
            return;
        }
        let (begun, first_ns) = *self.since.get_or_insert_with(|| (Instant::now(), time_ns));
        let due = Duration::from_nanos(time_ns.saturating_sub(first_ns)).div_f64(self.speed);
        while self.stream.is_watched() && !self.is_interrupted() {
            match due.saturating_sub(begun.elapsed()) {
                Duration::ZERO => break,
                left => thread::sleep(left.min(TICK)),
            }
        }
    }

    /// Waits until the last viewer has disconnected. Ctrl-C also ends the wait.
    pub fn stay(&self) {
        while self.stream.has_viewers() && !self.is_interrupted() {
            thread::sleep(TICK);
        }
    }

    /// Returns true if Ctrl-C was pressed.
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.came()
    }
}

#[cfg(feature = "live")]
fn open(port: u16, origins: &[Origin]) -> Result<Stream, Failure> {
    Stream::open(port, origins).map_err(|fault| {
        let message = format!("cannot stream on port {port}: {fault}; choose another `--port`");
        Failure::new(ErrorKind::Io, message)
    })
}

/// An uninhabited type: without the feature there is never a stream.
#[cfg(not(feature = "live"))]
enum Stream {}

#[cfg(not(feature = "live"))]
impl Stream {
    fn url(&self) -> String {
        match *self {}
    }

    fn is_watched(&self) -> bool {
        match *self {}
    }

    fn has_viewers(&self) -> bool {
        match *self {}
    }

    fn send(&mut self, _: Topic, _: u64, _: &[u8]) {
        match *self {}
    }
}

#[cfg(not(feature = "live"))]
fn open(_: u16, _: &[Origin]) -> Result<Stream, Failure> {
    let message = "this program was built without `--live`: build it with \
                   `cargo build --features live`";
    Err(Failure::new(ErrorKind::Usage, message))
}
