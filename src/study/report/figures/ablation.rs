//! The contribution of switches: the success of every combination, and the effect of each switch.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{Drawing, Drawn, Size};
use super::theme::{BLUE, CENTRED, FAINT, FROM_LEFT, INK, RED, Theme, colour};
use crate::study::analysis::summary::ArmRecords;
use crate::study::report::ablation::{Place, SwitchEffect, place, places, short, state, switches};
use crate::study::statistics::{Interval, Proportion};

const TOP: u32 = 40;
const BARS: Size = (560, 170);
const EFFECTS: u32 = 440;
/// Width of the names of the switches, left of the bars.
const NAMES: u32 = 190;
const ROW: u32 = 20;

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

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

    fn table_top(&self) -> u32 {
        TOP + self.places.len() as u32 * BARS.1
    }
}

impl Drawing for Ablation<'_> {
    fn size(&self) -> Size {
        let table = (self.switches.len() as u32 + 1) * ROW + 24;
        (NAMES + BARS.0 + EFFECTS, self.table_top() + table)
    }

    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let bars = (theme.px(NAMES + BARS.0 / 2) as i32, theme.ipx(18));
        let title = "Trials with an optimal policy, by combination";
        root.draw_text(title, &theme.text(16).pos(CENTRED), bars)?;
        let effects = (
            theme.px(NAMES + BARS.0 + EFFECTS / 2 + 50) as i32,
            theme.ipx(18),
        );
        let title = "Main effect of each switch (95 %)";
        root.draw_text(title, &theme.text(16).pos(CENTRED), effects)?;
        for (i, name) in self.places.iter().enumerate() {
            let top = TOP + i as u32 * BARS.1;
            let area = root.clone().shrink(
                (theme.px(8), theme.px(top)),
                (theme.px(NAMES), theme.px(BARS.1)),
            );
            self.name(&area, theme, name)?;
            self.bars(root, theme, name, top)?;
            self.effects(root, theme, name, top)?;
        }
        self.table(root, theme)
    }
}

impl Ablation<'_> {
    fn name<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        theme: Theme,
        name: &Place,
    ) -> Drawn<DB> {
        let parts = name.1.split(", ");
        for (line, part) in std::iter::once(name.0.as_str()).chain(parts).enumerate() {
            let size = if line == 0 { 15 } else { 12 };
            let y = theme.ipx((BARS.1 / 2) as i32 - 24 + 18 * line as i32);
            area.draw_text(part, &theme.text(size).pos(FROM_LEFT), (0, y))?;
        }
        Ok(())
    }

    fn bars<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        name: &Place,
        top: u32,
    ) -> Drawn<DB> {
        let corner = (theme.px(NAMES - 50), theme.px(top));
        let area = root
            .clone()
            .shrink(corner, (theme.px(BARS.0 + 50), theme.px(BARS.1)));
        let arms = self.combinations(name);
        let mut chart = ChartBuilder::on(&area)
            .set_label_area_size(LabelAreaPosition::Left, theme.px(50))
            .margin_top(theme.px(8))
            .margin_bottom(theme.px(8))
            .build_cartesian_2d(0.0..arms.len() as f64, 0.0..1.0)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .disable_x_axis()
            .light_line_style(TRANSPARENT)
            .bold_line_style(theme.line(FAINT, 1))
            .axis_style(theme.line(INK, 1))
            .y_labels(6)
            .y_label_formatter(&|share| format!("{:.0} %", 100.0 * share))
            .label_style(theme.text(11))
            .draw()?;
        let shares: Vec<Proportion> = arms.iter().map(|one| one.successes()).collect();
        let bar = |(i, share): (usize, &Proportion)| {
            let corners = [(i as f64 + 0.15, 0.0), (i as f64 + 0.85, share.share())];
            Rectangle::new(corners, colour(BLUE).mix(0.75).filled())
        };
        chart.draw_series(shares.iter().enumerate().map(bar))?;
        let whisker = |(i, share): (usize, &Proportion)| {
            let (middle, wilson) = (i as f64 + 0.5, share.wilson());
            PathElement::new(
                [(middle, wilson.low), (middle, wilson.high)],
                theme.line(INK, 1),
            )
        };
        chart.draw_series(shares.iter().enumerate().map(whisker))?;
        Ok(())
    }

    /// Draws the table under the bars, which shows the switches that are on.
    fn table<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let arms = self.combinations(&self.places[0]);
        let width = f64::from(theme.px(BARS.0)) / arms.len() as f64;
        for (line, switch) in self.switches.iter().enumerate() {
            let y = theme.px(self.table_top() + 12 + line as u32 * ROW) as i32;
            root.draw_text(
                &short(switch),
                &theme.text(12).pos(FROM_LEFT),
                (theme.ipx(8), y),
            )?;
            for (i, one) in arms.iter().enumerate() {
                let x = f64::from(theme.px(NAMES)) + (i as f64 + 0.5) * width;
                let style = match state(one.arm, switch) {
                    Some(true) => INK.filled(),
                    _ => FAINT.filled(),
                };
                root.draw(&Circle::new((x as i32, y), theme.ipx(5), style))?;
            }
        }
        let y = theme.px(self.table_top() + 14 + self.switches.len() as u32 * ROW) as i32;
        let x = theme.px(NAMES + BARS.0 / 2) as i32;
        let note = "dark: on; whiskers: 95 % (Wilson)";
        root.draw_text(note, &theme.text(12).pos(CENTRED), (x, y))
    }

    /// Draws the main effects as dots with intervals, in percentage points.
    fn effects<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        name: &Place,
        top: u32,
    ) -> Drawn<DB> {
        let names = 160;
        let corner = (theme.px(NAMES + BARS.0 + 14), theme.px(top));
        let area = root
            .clone()
            .shrink(corner, (theme.px(EFFECTS - 14), theme.px(BARS.1)));
        let own: Vec<&SwitchEffect> = self
            .effects
            .iter()
            .filter(|one| (&one.world, &one.setting) == (&name.0, &name.1))
            .collect();
        let mut chart = ChartBuilder::on(&area)
            .set_label_area_size(LabelAreaPosition::Left, theme.px(names))
            .set_label_area_size(LabelAreaPosition::Bottom, theme.px(34))
            .margin_right(theme.px(16))
            .margin_top(theme.px(8))
            .build_cartesian_2d(self.reach(), 0.0..own.len() as f64)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .light_line_style(TRANSPARENT)
            .bold_line_style(theme.line(FAINT, 1))
            .axis_style(theme.line(INK, 1))
            .x_labels(7)
            .x_label_formatter(&|points| format!("{points:+.0}"))
            .x_desc("percentage points")
            .axis_desc_style(theme.text(11))
            .label_style(theme.text(11))
            .draw()?;
        self.dots(root, &mut chart, theme, &own)
    }

    /// Draws the name, the interval and the value of each effect.
    fn dots<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        chart: &mut Chart<'_, DB>,
        theme: Theme,
        effects: &[&SwitchEffect],
    ) -> Drawn<DB> {
        let height = effects.len() as f64;
        let zero = PathElement::new([(0.0, 0.0), (0.0, height)], theme.line(INK, 1));
        chart.draw_series([zero])?;
        for (i, effect) in effects.iter().enumerate() {
            let y = height - i as f64 - 0.5;
            let Interval { value, low, high } = effect.main_effect;
            let range = [(100.0 * low, y), (100.0 * high, y)];
            chart.draw_series([PathElement::new(range, theme.line(colour(RED), 2))])?;
            let dot = Circle::new((100.0 * value, y), theme.px(4), colour(RED).filled());
            chart.draw_series([dot])?;
            let place = (
                theme.px(NAMES + BARS.0 + 26) as i32,
                chart.backend_coord(&(0.0, y)).1,
            );
            root.draw_text(
                &short(&effect.switch),
                &theme.text(12).pos(FROM_LEFT),
                place,
            )?;
        }
        Ok(())
    }

    /// Returns the range of the axis, which is the same for all places.
    fn reach(&self) -> std::ops::Range<f64> {
        let intervals = self.effects.iter().map(|one| one.main_effect);
        let ends = intervals.flat_map(|one| [one.low.abs(), one.high.abs()]);
        let widest = (100.0 * ends.fold(0.05, f64::max) / 10.0).ceil() * 10.0;
        -widest..widest
    }
}
