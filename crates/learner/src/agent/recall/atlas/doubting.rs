//! Charts where cells are misread: what all episodes saw of their cells, whatever these are, is to be as
//! likely as can be. So a place that is none costs what its cells could be, and two goals on one chart cost
//! what contradicts itself.

use super::super::align::{Alignment, Seen, align};
use super::super::chart::Chart;
use super::super::sightings::Sightings;
use super::Atlas;

/// How much likelier an episode must be on a blank chart to open one for it, in bits.
pub(super) const TO_OPEN: f64 = 3.0;
/// What a step costs of which is not certain where it was: as if nothing were known of the cells around.
const LOST: f64 = 9.0;

/// How an episode lies on a chart.
#[derive(Debug, Clone)]
pub(super) struct Laid {
    /// The number of the chart.
    pub at: usize,
    pub alignment: Alignment,
    /// What it sees of the cells.
    pub seen: Sightings,
    /// How likely its moves are, as a logarithm to the base 2.
    pub bits: f64,
}

impl Atlas {
    /// Lays an episode on a chart, which has this number.
    fn lay_on(&self, steps: &[Seen], at: usize, chart: &Chart) -> Laid {
        let alignment = align(steps, chart, &self.habits);
        let lost = alignment.places.iter().filter(|place| place.is_none());
        let slip = libm::log2(self.habits.slip / self.habits.headings.actions() as f64);
        Laid {
            at,
            seen: Sightings::of(steps, &alignment.places, self.habits.vision.of_a_goal()),
            bits: alignment.slips * slip - LOST * lost.count() as f64,
            alignment,
        }
    }

    /// How many charts are not blank.
    pub(super) fn used(&self) -> usize {
        self.sheets
            .iter()
            .filter(|sheet| sheet.episodes > 0.0)
            .count()
    }

    /// The number of a blank chart, if there may be one more.
    pub(super) fn room(&self) -> Option<usize> {
        let blank = self.sheets.iter().position(|sheet| sheet.episodes == 0.0);
        let room = self.used() < self.params.charts as usize;
        room.then(|| blank.unwrap_or(self.sheets.len()))
    }

    /// Where an episode is likeliest beside what was seen on each chart, which may be a blank one.
    pub(super) fn likeliest(&self, steps: &[Seen], seen: &[Sightings], may_open: bool) -> Laid {
        let misread = self.habits.misread;
        let laid = self.sheets.iter().enumerate();
        let laid = laid.filter(|(_, sheet)| sheet.episodes > 0.0);
        let laid = laid.map(|(at, sheet)| {
            let laid = self.lay_on(steps, at, &sheet.chart);
            let bits = laid.bits + seen[at].bits_of(&laid.seen, misread);
            (laid, bits)
        });
        let room = self.room().filter(|_| may_open || self.used() == 0);
        let blank = room.map(|at| {
            let laid = self.lay_on(steps, at, &Chart::default());
            let bits = laid.bits + laid.seen.bits(misread) - TO_OPEN;
            (laid, bits)
        });
        let all = laid.chain(blank);
        let best = all.reduce(|best, one| if one.1 > best.1 { one } else { best });
        best.expect("there is a chart, or room for one").0
    }

    /// The same beside what charts hold.
    pub(super) fn lay_doubting(&self, steps: &[Seen]) -> (usize, Alignment) {
        let laid = self.likeliest(steps, &self.seen_on_charts(), true);
        (laid.at, laid.alignment)
    }

    /// What was seen on each chart.
    pub(super) fn seen_on_charts(&self) -> Vec<Sightings> {
        let sheets = self.sheets.iter();
        sheets
            .map(|sheet| Sightings::of_chart(&sheet.chart))
            .collect()
    }
}
