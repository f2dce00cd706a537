//! A recording as text for a terminal: the maze with the robot and its decision, at any time.

use std::borrow::Cow;
use std::collections::BTreeSet;

use serde_json::Value;
use textwrap::{Options, WordSplitter};

use super::data::{Data, Timed, world};
use crate::error::Error;
use crate::record::RecordingKind;
use crate::record::reader::Recording;
use crate::world::{Cell, Maze};

/// The least number of lines without the maze: the caption, five lines of the decision, and the time.
const WORDS: usize = 7;
/// The robot's glyph by heading, in eighths of a turn, from east to the left.
const HEADINGS: [char; 8] = ['▶', '◥', '▲', '◤', '◀', '◣', '▼', '◢'];

/// Plays a recording as text.
#[derive(Debug)]
pub struct TextPlayer {
    data: Data,
    maze: Maze,
}

impl TextPlayer {
    /// Reads a recording of a run, of an episode, or of highlights.
    ///
    /// # Errors
    /// If messages cannot be decoded, the world is missing, or the
    /// recording shows two runs.
    pub fn of(recording: &Recording) -> Result<Self, Error> {
        if recording.extent() == Some(RecordingKind::Comparison) {
            let cause = "it compares two runs; give a recording of one of them";
            return Err(recording.damaged(cause.to_owned()));
        }
        Ok(Self {
            data: Data::of(recording, None)?,
            maze: world(recording, "")?,
        })
    }

    /// Returns the duration, in seconds.
    pub fn end_s(&self) -> f64 {
        self.data.end
    }

    /// Returns the times of the robot's decisions, in seconds, in order.
    pub fn decisions_s(&self) -> Vec<f64> {
        self.data.decisions.iter().map(time_s).collect()
    }

    /// Returns the state at a time in seconds, in at most this many columns and lines. A larger
    /// maze is cropped around the robot.
    pub fn frame(&self, t_s: f64, (columns, rows): (usize, usize)) -> String {
        let data = &self.data;
        let caption = last(&data.captions, t_s).map_or(data.heading(), |one| text(one, "title"));
        let mut lines = vec![caption.to_owned()];
        lines.extend(self.maze(t_s, (columns / 2, rows.saturating_sub(WORDS))));
        // Long lines take the rows that the maze leaves.
        let mut spare = rows.saturating_sub(WORDS + lines.len() - 1);
        for line in self.decision(t_s) {
            let pieces = wrapped(&line, columns, 1 + spare);
            spare -= pieces.len() - 1;
            lines.extend(pieces);
        }
        lines.push(format!("{} / {}", clock(t_s), clock(data.end)));
        let lines: Vec<String> = lines.iter().map(|line| cut(line, columns)).collect();
        lines.join("\n")
    }

    /// Returns the maze with the path since the start of the episode, in at most this many cells.
    fn maze(&self, t_s: f64, (columns, rows): (usize, usize)) -> Vec<String> {
        let maze = &self.maze;
        let begun_s = last(&self.data.begins, t_s).map_or(0.0, time_s);
        let path = self.data.poses.iter();
        let path = path.filter(|pose| (begun_s..=t_s).contains(&pose[0]));
        let path = path.filter_map(|pose| Some((maze.cell_at([pose[1], pose[2]].into())?, pose)));
        let path: Vec<_> = path.collect();
        let robot = path.last().map(|(cell, pose)| (*cell, pose[3]));
        let visited: BTreeSet<usize> = path.iter().map(|(cell, _)| maze.index(*cell)).collect();
        let glyph = |cell: Cell| match robot {
            Some((at, yaw_rad)) if at == cell => {
                let in_grid_rad = yaw_rad - maze.origin().yaw_rad;
                let eighth = (in_grid_rad / std::f64::consts::FRAC_PI_4).round() as i64;
                Some(HEADINGS[eighth.rem_euclid(8) as usize])
            }
            _ if maze.is_goal(cell) || maze.start() == Some(cell) => None,
            _ => visited.contains(&maze.index(cell)).then_some('·'),
        };
        let centre = robot.map_or((0, 0), |(cell, _)| (cell.col, cell.row));
        let shown = |at: u16, size: u16, room: usize| {
            let (at, size) = (usize::from(at), usize::from(size));
            let from = at.saturating_sub(room / 2).min(size.saturating_sub(room));
            from..size.min(from + room)
        };
        let columns = shown(centre.0, maze.width(), columns);
        let rows = shown(centre.1, maze.height(), rows);
        let picture = maze.drawn(glyph);
        let lines = picture.lines().skip(rows.start).take(rows.len());
        let lines = lines.map(|line| {
            let letters = line.chars().skip(2 * columns.start);
            letters.take(2 * columns.len()).collect()
        });
        lines.collect()
    }

    /// Returns the decision as text, in five lines.
    fn decision(&self, t_s: f64) -> [String; 5] {
        let data = &self.data;
        let begun_s = last(&data.begins, t_s).map_or(0.0, time_s);
        let episode = last(&data.episodes, t_s).map_or_else(String::new, |one| {
            format!("episode {}", one.get("episode").unwrap_or(&Value::Null))
        });
        let decision = last(&data.decisions, t_s).filter(|one| time_s(one) >= begun_s);
        let Some(decision) = decision else {
            return [&episode, "", "", "", ""].map(str::to_owned);
        };
        let (step, action) = (decision.get("step"), text(decision, "action"));
        let step = step.unwrap_or(&Value::Null);
        let chosen_by = match text(decision, "chosen_by") {
            "rules" => "a rule",
            "table" => "the table or plan",
            "planner" => "planned exploration",
            other => other,
        };
        [
            format!("{episode}, step {step}: {action}, chosen by {chosen_by}"),
            text(decision, "rule").to_owned(),
            format!("perceived: {}", text(decision, "seen")),
            format!("values: {}", self.values(decision)),
            last(&data.estimates, t_s).map_or_else(String::new, estimate),
        ]
    }

    fn values(&self, decision: &Timed) -> String {
        let values = decision.get("values").and_then(Value::as_array);
        let values = values.into_iter().flatten().zip(&self.data.actions);
        let named = values.map(|(value, action)| match value.as_f64() {
            Some(value) => format!("{action} {value:.1}"),
            None => format!("{action} unknown"),
        });
        named.collect::<Vec<_>>().join(", ")
    }
}

/// Returns the last entry at or before a time.
fn last(entries: &[Timed], t_s: f64) -> Option<&Timed> {
    let after = entries.partition_point(|entry| time_s(entry) <= t_s);
    entries[..after].last()
}

fn time_s(entry: &Timed) -> f64 {
    entry.get("t").and_then(Value::as_f64).unwrap_or(0.0)
}

fn text<'a>(entry: &'a Timed, key: &str) -> &'a str {
    entry.get(key).and_then(Value::as_str).unwrap_or("")
}

fn estimate(estimate: &Timed) -> String {
    let number = |key| estimate.get(key).and_then(Value::as_f64).unwrap_or(0.0);
    let mislocalised = match estimate.get("mislocalised") {
        Some(Value::Bool(true)) => ", mislocalised",
        _ => "",
    };
    let (off_cm, off_deg) = (100.0 * number("error_m"), number("heading_error_deg").abs());
    let sd_cm = 100.0 * libm::hypot(number("sd_x_m"), number("sd_y_m"));
    let sd_deg = number("sd_heading_deg");
    format!(
        "position: ± {sd_cm:.1} cm, ± {sd_deg:.1}°, off by {off_cm:.1} cm, {off_deg:.1}°{mislocalised}"
    )
}

/// Breaks a line between words into at least one and at most `most` lines of at most this many
/// columns. What does not fit stays in the last one.
fn wrapped(line: &str, columns: usize, most: usize) -> Vec<String> {
    let options = Options::new(columns)
        .subsequent_indent("  ")
        .break_words(false)
        .word_splitter(WordSplitter::NoHyphenation);
    let lines = textwrap::wrap(line, options).into_iter();
    let mut lines: Vec<String> = lines.map(Cow::into_owned).collect();
    for rest in lines.split_off(most.min(lines.len())) {
        lines[most - 1] += &rest[1..];
    }
    lines
}

/// Formats a time as minutes and seconds.
fn clock(t_s: f64) -> String {
    format!("{}:{:04.1}", (t_s / 60.0).floor(), t_s % 60.0)
}

fn cut(line: &str, columns: usize) -> String {
    match line.chars().count() > columns {
        true => line
            .chars()
            .take(columns.saturating_sub(1))
            .chain(['…'])
            .collect(),
        false => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_lines_are_cut_to_what_fits() {
        assert_eq!([clock(0.0), clock(75.26)], ["0:00.0", "1:15.3"]);
        assert_eq!(cut("north", 5), "north");
        assert_eq!(cut("north-east", 5), "nort…");
        let most = |lines| wrapped("north wall, east free", 11, lines);
        assert_eq!(most(9), ["north wall,", "  east free"]);
        assert_eq!(most(1), ["north wall, east free"]);
        assert_eq!(wrapped("", 11, 3), [""]);
    }
}
