//! A sweep of two settings as a heat map.

use plotters::coord::Shift;
use plotters::prelude::*;
use serde_json::Value;

use super::canvas::{Drawing, Drawn, Size};
use super::theme::{BLUE, CENTRED, FROM_LEFT, FROM_RIGHT, INK, Theme, colour};
use crate::study::analysis::summary::ArmSummary;
use crate::study::protocol::Arm;

const TOP: u32 = 62;
/// Height of the panel's name, and below it the name of the row setting.
const CAPTION: u32 = 46;
const LABELS: u32 = 52;
/// Width of the values and the name of the row setting.
const LEFT: u32 = 130;
const CELL: Size = (76, 44);
const GAP: u32 = 24;
/// Maximum number of panels in a row.
const MOST_COLUMNS: usize = 3;
/// Maximum number of values of a setting.
const MOST_VALUES: usize = 12;
/// Minimum width, for the note.
const NOTE: u32 = 560;

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
        let [columns, rows] = [0, 1].map(|axis| self.values[axis].len() as u32);
        (
            LEFT + columns * CELL.0 + GAP,
            CAPTION + rows * CELL.1 + LABELS,
        )
    }

    fn columns(&self) -> usize {
        self.panels.len().clamp(1, MOST_COLUMNS)
    }
}

fn index_of(values: &mut Vec<Value>, value: &Value) -> usize {
    values
        .iter()
        .position(|known| known == value)
        .unwrap_or_else(|| {
            values.push(value.clone());
            values.len() - 1
        })
}

fn shown(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

impl Drawing for Heat<'_> {
    fn size(&self) -> Size {
        let (width, height) = self.panel_size();
        let rows = self.panels.len().div_ceil(self.columns());
        (
            NOTE.max(self.columns() as u32 * width),
            TOP + rows as u32 * height,
        )
    }

    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let middle = theme.px(self.size().0 / 2) as i32;
        let title = "Optimal trials by two settings";
        root.draw_text(title, &theme.text(17).pos(CENTRED), (middle, theme.ipx(18)))?;
        let note = "the share of optimal trials, and below the environment steps until then (IQM)";
        root.draw_text(note, &theme.text(12).pos(CENTRED), (middle, theme.ipx(42)))?;
        let mut panels = self.panels.iter().enumerate();
        panels.try_for_each(|(number, (name, entries))| {
            let (width, height) = self.panel_size();
            let (row, column) = (number / self.columns(), number % self.columns());
            let corner = (column as u32 * width, TOP + row as u32 * height);
            self.axes(root, theme, corner, name)?;
            entries
                .iter()
                .try_for_each(|entry| Self::cell(root, theme, corner, entry))
        })
    }
}

impl Heat<'_> {
    /// Draws the name of a panel, and the names and values of both settings.
    fn axes<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        (left, top): (u32, u32),
        name: &str,
    ) -> Drawn<DB> {
        let at = |x: u32, y: u32| (theme.px(x) as i32, theme.px(y) as i32);
        let [columns, rows] = &self.values;
        let (wide, high) = (columns.len() as u32 * CELL.0, rows.len() as u32 * CELL.1);
        let centre = left + LEFT + wide / 2;
        let text = |size| theme.text(size).pos(CENTRED);
        let title = theme.text(14).pos(FROM_LEFT);
        root.draw_text(name, &title, at(left + 16, top + 12))?;
        let bottom = top + CAPTION + high;
        for (column, value) in columns.iter().enumerate() {
            let x = left + LEFT + column as u32 * CELL.0 + CELL.0 / 2;
            root.draw_text(&shown(value), &text(12), at(x, bottom + 12))?;
        }
        root.draw_text(&self.keys[0], &text(12), at(centre, bottom + 32))?;
        let beside = theme.text(12).pos(FROM_RIGHT);
        for (row, value) in rows.iter().enumerate() {
            let y = top + CAPTION + row as u32 * CELL.1 + CELL.1 / 2;
            root.draw_text(&shown(value), &beside, at(left + LEFT - 8, y))?;
        }
        let corner = at(left + LEFT - 8, top + CAPTION - 12);
        root.draw_text(&self.keys[1], &beside, corner)
    }

    /// Draws the cell of a combination. More optimal trials make it darker.
    fn cell<DB: DrawingBackend>(
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        (left, top): (u32, u32),
        (column, row, arm): &Entry<'_>,
    ) -> Drawn<DB> {
        let share = arm.successes as f64 / arm.trials.max(1) as f64;
        let x = left + LEFT + *column as u32 * CELL.0;
        let y = top + CAPTION + *row as u32 * CELL.1;
        let corners = [(x, y), (x + CELL.0 - 2, y + CELL.1 - 2)];
        let corners = corners.map(|(x, y)| (theme.px(x) as i32, theme.px(y) as i32));
        let fill = colour(BLUE).mix(0.06 + 0.94 * share).filled();
        root.draw(&Rectangle::new(corners, fill))?;
        // Light text on dark cells.
        let ink = if share > 0.55 { WHITE } else { INK };
        let text = |size| theme.text(size).pos(CENTRED).color(&ink);
        let at = |down: u32| (theme.px(x + CELL.0 / 2) as i32, theme.px(y + down) as i32);
        root.draw_text(&format!("{:.0} %", 100.0 * share), &text(13), at(14))?;
        let steps = arm
            .iqm_env_steps
            .map_or("–".to_owned(), |steps| format!("{steps:.0}"));
        root.draw_text(&steps, &text(11), at(31))
    }
}
