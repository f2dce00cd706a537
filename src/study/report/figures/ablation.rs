//! The contribution of switches: the success of every combination, and the effect of each switch.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{Canvas, Chart, Drawing, Drawn, Size, write};
use super::theme::{BLUE, CENTRED, FAINT, FROM_LEFT, INK, RED, colour, line, text};
use crate::study::analysis::summary::ArmRecords;
use crate::study::report::ablation::{Place, SwitchEffect, place, places, short, state, switches};
use crate::study::statistics::{Interval, Proportion};

const TOP: i32 = 40;
const BARS: Size = (560, 170);
const EFFECTS: i32 = 440;
/// Width of the names of the switches, left of the bars.
const NAMES: i32 = 190;
const ROW: i32 = 20;

type Effects<'a, 'b> = Chart<'a, 'b, RangedCoordf64, RangedCoordf64>;

/// A row for each place. It has bars of the success of every combination, over a table of dots that
/// shows which switches are on. The main effects of the switches are next to them.
#[derive(Debug)]
pub struct Ablation<'a> {
    arms: &'a [ArmRecords<'a>],
    switches: Vec<String>,
    places: Vec<Place>,
    effects: Vec<SwitchEffect>,
}

impl<'a> Ablation<'a> {
    /// Creates the chart of a study's arms. `None` if the study has no switches.
    pub fn new(arms: &'a [ArmRecords<'a>]) -> Option<Self> {
        let switches = switches(arms);
        (!switches.is_empty()).then(|| Self {
            arms,
            switches,
            places: places(arms),
            effects: SwitchEffect::all(arms),
        })
    }

    /// Returns the arms in one place, those with fewer switches on first.
    fn combinations(&self, name: &Place) -> Vec<&ArmRecords<'a>> {
        let mut arms: Vec<_> = self
            .arms
            .iter()
            .filter(|one| place(one.arm) == *name)
            .collect();
        let on = |one: &&ArmRecords<'a>| {
            let on = self
                .switches
                .iter()
                .filter(|switch| state(one.arm, switch) == Some(true));
            on.count()
        };
        arms.sort_by_key(on);
        arms
    }

    fn table_top(&self) -> i32 {
        TOP + self.places.len() as i32 * BARS.1
    }
}

impl Drawing for Ablation<'_> {
    fn size(&self) -> Size {
        let table = (self.switches.len() as i32 + 1) * ROW + 24;
        (NAMES + BARS.0 + EFFECTS, self.table_top() + table)
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let title = "Trials with an optimal policy, by combination";
        write(canvas, 16, CENTRED, (NAMES + BARS.0 / 2, 18), title)?;
        let middle = NAMES + BARS.0 + EFFECTS / 2 + 50;
        let title = "Main effect of each switch (95 %)";
        write(canvas, 16, CENTRED, (middle, 18), title)?;
        for (i, name) in self.places.iter().enumerate() {
            let top = TOP + i as i32 * BARS.1;
            write_place(canvas, name, top)?;
            self.bars(canvas, name, top)?;
            self.effects(canvas, name, top)?;
        }
        self.table(canvas)
    }
}

fn write_place(canvas: &Canvas<'_>, (world, setting): &Place, top: i32) -> Drawn {
    write(canvas, 15, FROM_LEFT, (8, top + BARS.1 / 2 - 24), world)?;
    for (part, line) in setting.split(", ").zip(1..) {
        let y = top + BARS.1 / 2 - 24 + 18 * line;
        write(canvas, 12, FROM_LEFT, (8, y), part)?;
    }
    Ok(())
}

impl Ablation<'_> {
    fn bars(&self, canvas: &Canvas<'_>, name: &Place, top: i32) -> Drawn {
        let size = (BARS.0 + 50, BARS.1);
        let area = canvas.clone().shrink((NAMES - 50, top), size);
        let arms = self.combinations(name);
        let mut chart = ChartBuilder::on(&area)
            .set_label_area_size(LabelAreaPosition::Left, 50)
            .margin_top(8)
            .margin_bottom(8)
            .build_cartesian_2d(0.0..arms.len() as f64, 0.0..1.0)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .disable_x_axis()
            .light_line_style(TRANSPARENT)
            .bold_line_style(line(FAINT, 1))
            .axis_style(line(INK, 1))
            .y_labels(6)
            .y_label_formatter(&|share| format!("{:.0} %", 100.0 * share))
            .label_style(text(11))
            .draw()?;
        let shares: Vec<Proportion> = arms.iter().map(|one| one.successes()).collect();
        let bar = |(i, share): (usize, &Proportion)| {
            let corners = [(i as f64 + 0.15, 0.0), (i as f64 + 0.85, share.share())];
            Rectangle::new(corners, colour(BLUE).mix(0.75).filled())
        };
        chart.draw_series(shares.iter().enumerate().map(bar))?;
        let whisker = |(i, share): (usize, &Proportion)| {
            let (middle, wilson) = (i as f64 + 0.5, share.wilson());
            PathElement::new([(middle, wilson.low), (middle, wilson.high)], line(INK, 1))
        };
        chart.draw_series(shares.iter().enumerate().map(whisker))?;
        Ok(())
    }

    /// Draws the table under the bars, which shows the switches that are on.
    fn table(&self, canvas: &Canvas<'_>) -> Drawn {
        let arms = self.combinations(&self.places[0]);
        let width = f64::from(BARS.0) / arms.len() as f64;
        let mut y = self.table_top() + 12;
        for switch in &self.switches {
            write(canvas, 12, FROM_LEFT, (8, y), &short(switch))?;
            for (i, one) in arms.iter().enumerate() {
                let x = f64::from(NAMES) + (i as f64 + 0.5) * width;
                let is_on = state(one.arm, switch) == Some(true);
                let style = if is_on { INK } else { FAINT }.filled();
                canvas.draw(&Circle::new((x as i32, y), 5, style))?;
            }
            y += ROW;
        }
        let note = "dark: on; whiskers: 95 % (Wilson)";
        write(canvas, 12, CENTRED, (NAMES + BARS.0 / 2, y + 2), note)
    }

    /// Draws the main effects as dots with intervals, in percentage points.
    fn effects(&self, canvas: &Canvas<'_>, (world, setting): &Place, top: i32) -> Drawn {
        let size = (EFFECTS - 14, BARS.1);
        let area = canvas.clone().shrink((NAMES + BARS.0 + 14, top), size);
        let own = self.effects.iter();
        let own = own.filter(|one| (&one.world, &one.setting) == (world, setting));
        let own: Vec<&SwitchEffect> = own.collect();
        let mut chart = ChartBuilder::on(&area)
            .set_label_area_size(LabelAreaPosition::Left, 160)
            .set_label_area_size(LabelAreaPosition::Bottom, 34)
            .margin_right(16)
            .margin_top(8)
            .build_cartesian_2d(self.reach(), 0.0..own.len() as f64)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .light_line_style(TRANSPARENT)
            .bold_line_style(line(FAINT, 1))
            .axis_style(line(INK, 1))
            .x_labels(7)
            .x_label_formatter(&|points| format!("{points:+.0}"))
            .x_desc("percentage points")
            .axis_desc_style(text(11))
            .label_style(text(11))
            .draw()?;
        dots(canvas, &mut chart, &own)
    }

    /// Returns the range of the axis, which is the same for all places.
    fn reach(&self) -> std::ops::Range<f64> {
        let intervals = self.effects.iter().map(|one| one.main_effect);
        let ends = intervals.flat_map(|one| [one.low.abs(), one.high.abs()]);
        let widest = (100.0 * ends.fold(0.05, f64::max) / 10.0).ceil() * 10.0;
        -widest..widest
    }
}

/// Draws the name, the interval and the value of each effect.
fn dots(canvas: &Canvas<'_>, chart: &mut Effects<'_, '_>, effects: &[&SwitchEffect]) -> Drawn {
    let height = effects.len() as f64;
    let zero = PathElement::new([(0.0, 0.0), (0.0, height)], line(INK, 1));
    chart.draw_series([zero])?;
    for (i, effect) in effects.iter().enumerate() {
        let y = height - i as f64 - 0.5;
        let Interval { value, low, high } = effect.main_effect;
        let range = [(100.0 * low, y), (100.0 * high, y)];
        chart.draw_series([PathElement::new(range, line(colour(RED), 2))])?;
        let dot = Circle::new((100.0 * value, y), 4, colour(RED).filled());
        chart.draw_series([dot])?;
        let (_, y) = chart.backend_coord(&(0.0, y));
        let at = (NAMES + BARS.0 + 26, y);
        write(canvas, 12, FROM_LEFT, at, &short(&effect.switch))?;
    }
    Ok(())
}
