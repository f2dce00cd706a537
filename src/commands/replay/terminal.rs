//! `xcscr replay --terminal`: plays a recording in the terminal.

use std::io::{self, IsTerminal};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use console::{Key, Term};
use xcscr::ErrorKind;
use xcscr::record::player::TextPlayer;

use super::highlights;
use crate::commands::failure::Failure;
use crate::commands::interrupt::Interrupt;
use crate::commands::results::{Results, Unwritten};
use crate::commands::terminal::escaped;

/// Time between two frames.
const PERIOD: Duration = Duration::from_millis(50);
const KEYS: &str = "space: play, pause   left, right: step   +, -: speed   q: quit";
/// Columns and rows of a frame if stdout is not a terminal. The rows are not limited.
const UNBOUNDED: (usize, usize) = (80, usize::MAX);

/// Plays one recording, or the highlights of a run, until `q` or Ctrl-C. If stdout is not a
/// terminal, prints a frame for each decision.
pub fn run(paths: &[PathBuf], out: &mut Results) -> Result<(), Failure> {
    let [path] = paths else {
        let message = "`--terminal` takes one recording, or one run".to_owned();
        return Err(Failure::new(ErrorKind::Usage, message));
    };
    let player = TextPlayer::of(&highlights::recording(path)?)?;
    if !io::stdout().is_terminal() {
        for t_s in player.decisions_s() {
            writeln!(out, "{}\n", player.frame(t_s, UNBOUNDED))?;
        }
        return Ok(());
    }
    let interrupt = Interrupt::notice()?;
    let term = Term::buffered_stdout();
    let played = play(Screen::new(player), &term, &interrupt);
    Ok(played.map_err(Unwritten)?)
}

/// Plays on a cleared screen, and shows the cursor again at the end.
fn play(mut screen: Screen, term: &Term, interrupt: &Interrupt) -> io::Result<()> {
    term.clear_screen()?;
    term.hide_cursor()?;
    let played = screen.play(term, interrupt);
    term.show_cursor()?;
    term.write_line("")?;
    term.flush()?;
    played
}

/// The player and its state.
struct Screen {
    player: TextPlayer,
    decisions_s: Vec<f64>,
    t_s: f64,
    is_playing: bool,
    speed: f64,
}

impl Screen {
    fn new(player: TextPlayer) -> Self {
        Self {
            decisions_s: player.decisions_s(),
            player,
            t_s: 0.0,
            is_playing: true,
            speed: 1.0,
        }
    }

    fn play(&mut self, term: &Term, interrupt: &Interrupt) -> io::Result<()> {
        let keys = keys();
        let mut before = Instant::now();
        loop {
            self.draw(term)?;
            match keys.recv_timeout(PERIOD) {
                Ok(Key::Char('q') | Key::Escape) => return Ok(()),
                Ok(key) => self.obey(&key),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) if !self.is_playing => return Ok(()),
                Err(RecvTimeoutError::Disconnected) => thread::sleep(PERIOD),
            }
            if interrupt.came() {
                return Ok(());
            }
            self.pass(before.elapsed());
            before = Instant::now();
        }
    }

    fn draw(&self, term: &Term) -> io::Result<()> {
        let (rows, columns) = term.size();
        let size = (usize::from(columns), usize::from(rows).saturating_sub(2));
        term.move_cursor_to(0, 0)?;
        let frame = self.player.frame(self.t_s, size);
        for line in escaped(&frame).lines() {
            term.clear_line()?;
            term.write_line(line)?;
        }
        // Clearing begins at the start of the line, so the last line comes after it.
        term.clear_to_end_of_screen()?;
        term.write_str(&format!("{}x   {KEYS}", self.speed))?;
        term.flush()
    }

    fn obey(&mut self, key: &Key) {
        let after = self
            .decisions_s
            .partition_point(|&decision_s| decision_s <= self.t_s);
        match key {
            Key::Char(' ') => self.is_playing = !self.is_playing,
            Key::Char('+') => self.speed = (self.speed * 2.0).min(64.0),
            Key::Char('-') => self.speed = (self.speed / 2.0).max(0.125),
            Key::ArrowRight => self.go_to(after),
            Key::ArrowLeft => self.go_to(after.saturating_sub(2)),
            Key::Home => self.go_to(0),
            _ => {}
        }
    }

    /// Goes to a decision and pauses.
    fn go_to(&mut self, decision: usize) {
        self.is_playing = false;
        self.t_s = self
            .decisions_s
            .get(decision)
            .copied()
            .unwrap_or(self.player.end_s());
    }

    /// Advances the time.
    fn pass(&mut self, elapsed: Duration) {
        if self.is_playing {
            self.t_s += elapsed.as_secs_f64() * self.speed;
        }
        if self.t_s >= self.player.end_s() {
            (self.t_s, self.is_playing) = (self.player.end_s(), false);
        }
    }
}

/// Returns the pressed keys. Without a terminal on stdin there are none.
fn keys() -> Receiver<Key> {
    let (sender, keys) = channel();
    thread::spawn(move || {
        let term = Term::stdout();
        while let Ok(key) = term.read_key() {
            // The thread must not wait for a key after the last one: the terminal would stay in the
            // mode for reading keys.
            let is_last = matches!(key, Key::Char('q') | Key::Escape);
            if sender.send(key).is_err() || is_last {
                break;
            }
        }
    });
    keys
}
