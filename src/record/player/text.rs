//! A recording as text for a terminal: the maze with the robot and its decision, at any time.

use serde_json::Value;

use super::data::{Data, Timed};
use crate::record::reader::Recording;
use crate::record::{RecordError, RecordingKind};

/// The number of lines without the maze: the caption, five lines of the decision, and the time.
const WORDS: usize = 7;
/// The robot's glyph by heading, in eighths of a turn, from east to the left.
const HEADINGS: [char; 8] = ['▶', '◥', '▲', '◤', '◀', '◣', '▼', '◢'];

/// Plays a recording as text.
#[derive(Debug)]
pub struct TextPlayer {
    data: Data,
}

impl TextPlayer {
    /// Reads a recording of a run, of an episode, or of highlights.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] if messages cannot be decoded, the world is missing, or the
    /// recording shows two runs.
    pub fn of(recording: &Recording) -> Result<Self, RecordError> {
        if recording.extent() == Some(RecordingKind::Comparison) {
            let cause = "it compares two runs; give a recording of one of them";
            return Err(recording.damaged(cause.to_owned()));
        }
        let data = Data::of(recording, None)?;
        Ok(Self { data })
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
        lines.extend(self.decision(t_s));
        lines.push(format!("{} / {}", clock(t_s), clock(data.end)));
        let lines: Vec<String> = lines.iter().map(|line| cut(line, columns)).collect();
        lines.join("\n")
    }

    /// Returns the maze with the path since the start of the episode. A cell is two letters wide.
    fn maze(&self, t_s: f64, (columns, rows): (usize, usize)) -> Vec<String> {
        let world = &self.data.world;
        let mut cells: Vec<Vec<[char; 2]>> = world.rows.iter().map(|row| drawn(row)).collect();
        let begun_s = last(&self.data.begins, t_s).map_or(0.0, time_s);
        let path = self.data.poses.iter();
        let path = path.filter(|pose| (begun_s..=t_s).contains(&pose[0]));
        let mut robot = None;
        for pose in path {
            let Some((column, row)) = world.cell(pose) else {
                continue;
            };
            if cells[row][column] == [' ', ' '] {
                cells[row][column] = ['·', ' '];
            }
            robot = Some((column, row, pose[3] - world.origin[2]));
        }
        let (column, row) = robot.map_or((0, 0), |(column, row, yaw_rad)| {
            let eighth = (yaw_rad / std::f64::consts::FRAC_PI_4).round() as i64;
            cells[row][column] = [HEADINGS[eighth.rem_euclid(8) as usize], ' '];
            (column, row)
        });
        let shown = |at: usize, size: usize, room: usize| {
            let from = at.saturating_sub(room / 2).min(size.saturating_sub(room));
            from..size.min(from + room)
        };
        let (rows, columns) = (
            shown(row, cells.len(), rows),
            shown(column, usize::from(world.width), columns),
        );
        let lines = cells[rows].iter();
        let lines = lines.map(|line| line[columns.clone()].iter().flatten().collect());
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

/// Returns the cells of a row, two letters each.
fn drawn(row: &str) -> Vec<[char; 2]> {
    let cell = |sign| match sign {
        '#' => ['█', '█'],
        '.' => [' ', ' '],
        mark => [mark, ' '],
    };
    row.chars().map(cell).collect()
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
    let lost = match estimate.get("lost") {
        Some(Value::Bool(true)) => ", mislocalised",
        _ => "",
    };
    let (position_cm, heading_deg) = (100.0 * number("error_m"), number("heading_error_deg").abs());
    format!("estimate off by {position_cm:.1} cm, {heading_deg:.1}°{lost}")
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
    }
}
