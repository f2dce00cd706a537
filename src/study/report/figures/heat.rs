//! A sweep of two settings as a heat map.

use plotters::prelude::*;
use serde_json::Value;

use super::canvas::{Canvas, Drawing, Drawn, Size, write, write_title};
use super::panels::index_of;
use super::theme::{BLUE, CENTRED, FROM_LEFT, FROM_RIGHT, INK, colour, text};
use crate::study::analysis::summary::ArmSummary;
use crate::study::protocol::Arm;

const TOP: i32 = 62;
/// Height of the panel's name, and below it the name of the row setting.
const CAPTION: i32 = 46;
const LABELS: i32 = 52;
/// Width of the values and the name of the row setting.
const LEFT: i32 = 130;
const CELL: Size = (76, 44);
const GAP: i32 = 24;
/// Maximum number of panels in a row.
const MOST_COLUMNS: usize = 3;
/// Maximum number of values of a setting.
const MOST_VALUES: usize = 12;
/// Minimum width, for the note.
const NOTE: i32 = 560;

/// A panel for each world, method, arena and sensor. Each cell is a combination of two swept
/// values.
#[derive(Debug)]
pub struct Heat<'a> {
    /// The names of the column setting and the row setting.
    keys: [String; 2],
    /// Their values.
    values: [Vec<Value>; 2],
    panels: Vec<(String, Vec<Entry<'a>>)>,
}

/// Column, row, and the result there.
type Entry<'a> = (usize, usize, &'a ArmSummary);

impl<'a> Heat<'a> {
    /// Creates the heat map of these arms. `None` unless exactly two settings are swept, with few
    /// values each.
    pub fn new(arms: &[Arm], summaries: &'a [ArmSummary]) -> Option<Self> {
        let keys: Vec<&String> = arms.first()?.variant.0.keys().collect();
        let [first, second] = keys[..] else {
            return None;
        };
        let mut values = [Vec::new(), Vec::new()];
        let mut panels: Vec<(String, Vec<Entry<'a>>)> = Vec::new();
        for (arm, summary) in arms.iter().zip(summaries) {
            let (column, row) = (arm.variant.0.get(first)?, arm.variant.0.get(second)?);
            let entry = (
                index_of(&mut values[0], column),
                index_of(&mut values[1], row),
                summary,
            );
            let names = [
                &arm.world,
                arm.method_name(),
                arm.arena.name(),
                arm.sensor.name(),
            ];
            let name = names.join(", ");
            match panels.iter_mut().find(|(known, _)| *known == name) {
                Some((_, entries)) => entries.push(entry),
                None => panels.push((name, vec![entry])),
            }
        }
        let fits = values
            .iter()
            .all(|values| (2..=MOST_VALUES).contains(&values.len()));
        let keys = [first.clone(), second.clone()];
        fits.then_some(Self {
            keys,
            values,
            panels,
        })
    }

    fn panel_size(&self) -> Size {
        let [columns, rows] = [0, 1].map(|axis| self.values[axis].len() as i32);
        (
            LEFT + columns * CELL.0 + GAP,
            CAPTION + rows * CELL.1 + LABELS,
        )
    }

    fn columns(&self) -> usize {
        self.panels.len().clamp(1, MOST_COLUMNS)
    }
}

fn shown(value: &Value) -> String {
    let text = value.as_str().map(str::to_owned);
    text.unwrap_or_else(|| value.to_string())
}

/// Draws the cell of a combination. More optimal trials make it darker.
fn cell(canvas: &Canvas<'_>, (left, top): Size, (column, row, arm): &Entry<'_>) -> Drawn {
    let share = arm.successes as f64 / arm.trials.max(1) as f64;
    let x = left + LEFT + *column as i32 * CELL.0;
    let y = top + CAPTION + *row as i32 * CELL.1;
    let corners = [(x, y), (x + CELL.0 - 2, y + CELL.1 - 2)];
    let fill = colour(BLUE).mix(0.06 + 0.94 * share).filled();
    canvas.draw(&Rectangle::new(corners, fill))?;
    // Light text on dark cells.
    let ink = if share > 0.55 { WHITE } else { INK };
    let text = |size| text(size).pos(CENTRED).color(&ink);
    let x = x + CELL.0 / 2;
    canvas.draw_text(&format!("{:.0} %", 100.0 * share), &text(13), (x, y + 14))?;
    let steps = arm.iqm_env_steps.map(|steps| format!("{steps:.0}"));
    canvas.draw_text(steps.as_deref().unwrap_or("–"), &text(11), (x, y + 31))
}

impl Drawing for Heat<'_> {
    fn size(&self) -> Size {
        let ((width, height), columns) = (self.panel_size(), self.columns());
        let rows = self.panels.len().div_ceil(columns) as i32;
        (NOTE.max(columns as i32 * width), TOP + rows * height)
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let title = "Optimal trials by two settings";
        let note = "the share of optimal trials, and below the environment steps until then (IQM)";
        write_title(canvas, self.size().0 / 2, title, Some((42, note)))?;
        let (width, height) = self.panel_size();
        for (number, (name, entries)) in self.panels.iter().enumerate() {
            let (row, column) = (number / self.columns(), number % self.columns());
            let corner = (column as i32 * width, TOP + row as i32 * height);
            self.axes(canvas, corner, name)?;
            entries
                .iter()
                .try_for_each(|entry| cell(canvas, corner, entry))?;
        }
        Ok(())
    }
}

impl Heat<'_> {
    /// Writes the name of a panel, and the names and values of both settings.
    fn axes(&self, canvas: &Canvas<'_>, (left, top): Size, name: &str) -> Drawn {
        write(canvas, 14, FROM_LEFT, (left + 16, top + 12), name)?;
        let [columns, rows] = &self.values;
        let (left, top) = (left + LEFT, top + CAPTION);
        let bottom = top + rows.len() as i32 * CELL.1;
        for (column, value) in columns.iter().enumerate() {
            let x = left + column as i32 * CELL.0 + CELL.0 / 2;
            write(canvas, 12, CENTRED, (x, bottom + 12), &shown(value))?;
        }
        let centre = left + columns.len() as i32 * CELL.0 / 2;
        write(canvas, 12, CENTRED, (centre, bottom + 32), &self.keys[0])?;
        for (row, value) in rows.iter().enumerate() {
            let y = top + row as i32 * CELL.1 + CELL.1 / 2;
            write(canvas, 12, FROM_RIGHT, (left - 8, y), &shown(value))?;
        }
        write(canvas, 12, FROM_RIGHT, (left - 8, top - 12), &self.keys[1])
    }
}
