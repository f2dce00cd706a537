//! All charts, drawn from the episodes that reached a goal.

mod doubting;
mod drawing;
mod redraw;

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use super::align::{Alignment, Habits, Seen, align, differing, slips};
use super::bumped::Bumped;
use super::chart::Chart;
use super::context::Felt;
use super::doubt::Tally;
use super::headings::{DISPLACEMENTS, Headings};
use super::likelihood::Likelihood;
use super::map::{Charted, MOST_CHARTS, Map, Worth};
use super::params::{MemoryParams, Odometry};
use super::place::{Around, Place, Vision};
use super::sheet::{KEPT_STEPS, Sheet, always_in, is_count};

/// Episodes that are kept to draw the charts anew.
const KEPT_EPISODES: usize = 100;
/// After so many successes the charts are drawn anew, if moves slip.
const REDRAWN_AFTER: [u32; 17] = [
    5, 10, 15, 20, 30, 40, 50, 65, 80, 100, 130, 160, 200, 300, 400, 600, 800,
];
/// Moves that slip less than this are taken for exact.
const EXACT: f64 = 0.008;
/// What is believed of slips and misread cells at first.
const FIRST_SLIP: f64 = 0.05;
const LEAST_MISREAD: f64 = 0.0005;
/// Looked-up percepts of which cells are misread less often than this are taken for right; sensed
/// ones are never held for better than this.
const RIGHT: f64 = 0.002;
/// How often moves slip counts as so many steps if it is brought from another world.
const BROUGHT_STEPS: f64 = 100.0;
/// So many cells must have differed before percepts are taken for noisy.
const LEAST_DIFFERING: f64 = 3.0;
/// Cells that were shown twice count beside so many that did not differ.
const SHOWN_AT_FIRST: f64 = 50.0;
/// How many times likelier an episode must be on a blank chart, to open one for it.
const BLANK_ADVANTAGE: f64 = 7.4;
/// How often what is believed of slips and misread cells is improved after each episode.
const ESTIMATED: usize = 3;
/// A chart that fewer episodes than this share belong to is not planned on.
const LEAST_SHARE: f64 = 0.05;

/// The charts, what is believed of moves and percepts, and the episodes that say so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Atlas {
    sheets: Vec<Sheet>,
    habits: Habits,
    /// Expected slips, and the steps among which they were counted.
    slips: [f64; 2],
    /// Cells in which two percepts differ, and all that two percepts show.
    misread: [f64; 2],
    episodes: VecDeque<Vec<Seen>>,
    /// Charts of another world, which all drawing begins with.
    brought: Vec<Sheet>,
    successes: u32,
    /// How often moves slip in plans, which do not change with every estimate.
    planned_slip: f64,
    /// By action: what it was certain to aim at after the last success. Charts and map are drawn with
    /// it, so that a map that is drawn again after an interruption is the same.
    drawn_with: Vec<Option<usize>>,
    #[serde(skip)]
    params: MemoryParams,
}

impl Atlas {
    /// An atlas without a chart, for a robot with so many actions.
    pub fn new(actions: usize, vision: Vision, params: MemoryParams) -> Self {
        let habits = Habits {
            headings: match params.odometry {
                Odometry::Known => Headings::known(actions),
                Odometry::None => Headings::unknown(actions),
            },
            vision,
            slip: FIRST_SLIP,
            misread: LEAST_MISREAD,
        };
        Self {
            sheets: Vec::new(),
            habits,
            slips: [0.0; 2],
            misread: [0.0; 2],
            episodes: VecDeque::new(),
            brought: Vec::new(),
            successes: 0,
            planned_slip: 0.0,
            drawn_with: habits.headings.all_certain(),
            params,
        }
    }

    /// The same with the settings of another.
    pub fn with_settings_of(mut self, other: &Self) -> Self {
        self.params = other.params.clone();
        self.habits.vision = other.habits.vision;
        self
    }

    /// Takes over the charts of a map that was drawn in another world. Each counts as one episode:
    /// one that nothing bears out is soon too rare to plan on.
    pub fn bring(&mut self, map: &Map) {
        for (spot, state) in map
            .spots
            .iter()
            .zip(0..)
            .filter(|(spot, _)| spot.eaten == 0)
        {
            let at = usize::from(spot.chart);
            while self.brought.len() <= at {
                self.brought
                    .push(Sheet::around(self.habits.vision.of_a_goal()));
            }
            let around = self.habits.vision.around(map.pomdp.percept(state));
            let sheet = &mut self.brought[at];
            sheet.chart.take_down(spot.place, &around);
            if map.begin == Some(state) {
                sheet.always_begins_in(spot.place);
            }
        }
        for sheet in &mut self.brought {
            sheet.chart = std::mem::take(&mut sheet.chart).seen_once();
        }
        self.sheets = self.brought.clone();
        self.planned_slip = map.pomdp.slip();
        self.slips = [BROUGHT_STEPS * map.pomdp.slip(), BROUGHT_STEPS];
        self.settle_habits();
    }

    /// The same with no charts but those that were brought and without an episode, but for what is
    /// believed of moves and percepts.
    fn blank(&self) -> Self {
        let Habits {
            headings, vision, ..
        } = &self.habits;
        Self {
            habits: self.habits,
            sheets: self.brought.clone(),
            brought: self.brought.clone(),
            successes: self.successes,
            ..Self::new(headings.actions(), *vision, self.params.clone())
        }
    }

    /// What is believed of moves and percepts.
    pub fn habits(&self) -> &Habits {
        &self.habits
    }

    /// Does the robot feel whether it bumped?
    pub fn feels_bumps(&self) -> bool {
        self.params.bumps
    }

    /// What the robot feels of a wall that barred its way.
    pub fn bumped(&self, felt: Felt) -> Bumped {
        match felt.bumped {
            _ if !self.params.bumps => Bumped::Unfelt,
            true => Bumped::Yes,
            false => Bumped::No,
        }
    }

    /// Learns from a step and what was seen after it (nothing at the goal) what its action aims at, if
    /// that is not known.
    pub fn follow(&mut self, step: &Seen, next: Option<&Around>) {
        if self.params.odometry == Odometry::None {
            self.habits.learn_heading(step, next);
        }
    }

    /// Learns from an episode whose last step led to a goal.
    pub fn learn(&mut self, mut steps: Vec<Seen>) {
        steps.drain(..steps.len().saturating_sub(KEPT_STEPS));
        self.successes = self.successes.saturating_add(1);
        if self.params.doubts {
            self.compare(&steps);
        }
        let fits = self.draw(&steps);
        if self.params.odometry == Odometry::None {
            let steps = steps.iter().zip(&fits);
            steps.for_each(|(step, fits)| self.habits.learn_in_context(step, fits));
        }
        self.episodes.push_back(steps);
        if self.episodes.len() > KEPT_EPISODES {
            self.episodes.pop_front();
        }
        self.settle_habits();
        if self.doubts() && self.params.odometry == Odometry::Known {
            self.estimate();
        }
        let inexact = self.habits.slip >= EXACT || self.misread() > 0.0;
        let certain = self.habits.headings.all_certain();
        if certain != self.drawn_with || REDRAWN_AFTER.contains(&self.successes) && inexact {
            self.redraw();
            self.drawn_with = certain;
        }
        self.planned_slip = slip_to_plan_with(self.habits.slip, self.planned_slip);
    }

    /// Compares what percepts of an episode show that follow each other, to learn how often cells
    /// are misread.
    fn compare(&mut self, steps: &[Seen]) {
        let differing = differing(steps, &self.habits);
        let fading = 0.99;
        let sums = self.misread.iter_mut().zip(differing);
        sums.for_each(|(sum, count)| *sum = *sum * fading + count);
        self.settle_misread();
    }

    /// Compares successive percepts; true once more than [`RIGHT`] of the cells are misread.
    pub fn notices_noise(&mut self, steps: &[Seen]) -> bool {
        if self.params.doubts {
            self.compare(steps);
        }
        self.misread[0] >= LEAST_DIFFERING && self.habits.misread >= RIGHT
    }

    fn settle_misread(&mut self) {
        let [differing, all] = self.misread;
        // Either of the two percepts was wrong.
        let misread = differing / 2.0 / (all + SHOWN_AT_FIRST);
        self.habits.misread = misread.clamp(LEAST_MISREAD, 0.25);
    }

    /// Learns from all kept episodes together how often moves slip and cells are misread: each is
    /// judged by how often the other is believed to happen.
    fn estimate(&mut self) {
        for _ in 0..ESTIMATED {
            let tally = Tally::of(self.episodes.iter(), &self.habits);
            (self.slips, self.misread) = (tally.slips, tally.differing);
            self.settle_habits();
            self.settle_misread();
        }
    }

    /// Are cells misread of which the robot is told what they are?
    fn doubts(&self) -> bool {
        self.habits.vision == Vision::LookedUp && self.misread() > 0.0
    }

    /// How often cells are misread; 0 if that is so rare that percepts are taken for right, which those
    /// of a lidar never are.
    fn misread(&self) -> f64 {
        let misread = self.habits.misread;
        match self.habits.vision {
            Vision::Lidar => misread.max(RIGHT),
            Vision::LookedUp if misread < RIGHT => 0.0,
            Vision::LookedUp => misread,
        }
    }

    /// Takes an episode down on the chart that it fits best; tells how well displacements fit there.
    fn draw(&mut self, steps: &[Seen]) -> Vec<[f64; DISPLACEMENTS]> {
        let (at, alignment) = match self.doubts() {
            true => self.lay_doubting(steps),
            false => self.lay(steps),
        };
        if at == self.sheets.len() {
            self.sheets.push(Sheet::default());
        }
        let sheet = &mut self.sheets[at];
        sheet.take_down(steps, &alignment);
        let goal = self.habits.vision.of_a_goal();
        sheet.chart.sight(Place::ORIGIN, goal);
        let fading = 0.99;
        self.slips[0] = self.slips[0] * fading + self.slips_of(steps, &alignment);
        self.slips[1] = self.slips[1] * fading + steps.len() as f64;
        alignment.fits
    }

    /// How many steps of an episode slipped. While directions are being learned, a step that goes another way
    /// than it seemed to aim is no slip, and only the chart tells.
    fn slips_of(&self, steps: &[Seen], alignment: &Alignment) -> f64 {
        match self.params.odometry {
            Odometry::Known => slips(steps, &self.habits),
            Odometry::None => alignment.slips,
        }
    }

    /// The chart that an episode fits best, and how it lies there; `None` if there is no chart.
    fn best_fit(&self, steps: &[Seen]) -> Option<(usize, Alignment)> {
        let charts = self.sheets.iter().map(|sheet| &sheet.chart).enumerate();
        let laid = charts.map(|(at, chart)| (at, align(steps, chart, &self.habits)));
        laid.reduce(|best, one| match one.1.likelihood > best.1.likelihood {
            true => one,
            false => best,
        })
    }

    /// The same, or the number of a new chart, if the episode fits none of them.
    fn lay(&self, steps: &[Seen]) -> (usize, Alignment) {
        let blank = || {
            let new = self.sheets.len();
            (new, align(steps, &Chart::default(), &self.habits))
        };
        let Some(best) = self.best_fit(steps) else {
            return blank();
        };
        if self.sheets.len() >= self.params.charts as usize {
            return best;
        }
        let Some(least) = self.least_to_open(steps, &best) else {
            return best;
        };
        let blank = blank();
        if blank.1.likelihood > least {
            blank
        } else {
            best
        }
    }

    /// How likely an episode must be on a blank chart to open one for it; `None` if nothing speaks against
    /// the one that it fits best. If cells are misread, none by itself speaks against a chart; but a blank
    /// one tells nothing, so the episode must be twice as likely there for each cell that the other tells.
    fn least_to_open(&self, steps: &[Seen], best: &(usize, Alignment)) -> Option<Likelihood> {
        let [contradicted, seen] = self.contradictions(steps, best);
        let likelihood = best.1.likelihood;
        let likelier = likelihood.times(BLANK_ADVANTAGE);
        if self.misread() > 0.0 {
            return Some(likelier.doubled(seen));
        }
        match self.habits.slip < EXACT {
            true => (contradicted > 0).then_some(likelihood.times(0.0)),
            false => (contradicted > 1).then_some(likelier),
        }
    }

    /// In how many cells an episode contradicts the chart on which it lies, and how many charted cells it
    /// sees.
    fn contradictions(&self, steps: &[Seen], (at, alignment): &(usize, Alignment)) -> [usize; 2] {
        let chart = &self.sheets[*at].chart;
        let placed = steps.iter().zip(&alignment.places);
        let placed = placed.filter_map(|(step, place)| Some((step, (*place)?)));
        let mut cells: BTreeMap<Place, bool> = BTreeMap::new();
        for (cell, agrees) in placed.flat_map(|(step, place)| chart.compare(place, &step.around)) {
            *cells.entry(cell).or_default() |= !agrees;
        }
        let contradicted = cells.values().filter(|contradicted| **contradicted);
        [contradicted.count(), cells.len()]
    }

    /// How often moves slip, as far as the last episodes tell.
    fn settle_habits(&mut self) {
        let [slips, steps] = self.slips;
        self.habits.slip = ((slips + FIRST_SLIP) / (steps + 1.0)).clamp(1e-4, 0.9);
    }

    /// The charted places as states to plan on, on all charts that are not rare.
    pub fn map(&self, worth: &Worth) -> Map {
        let all: f64 = self.sheets.iter().map(|sheet| sheet.episodes).sum();
        let used = self.sheets.iter();
        let used = used.filter(|sheet| sheet.episodes >= LEAST_SHARE * all);
        let charted: Vec<Charted<'_>> = used
            .clone()
            .map(|sheet| Charted::new(&sheet.chart, &sheet.payments, self.habits.vision))
            .collect();
        let map = Map::drawn(&charted, &self.drawn_with, self.planned_slip, worth);
        Map {
            misread: self.misread(),
            unfelt: !self.params.bumps,
            ..map.begun_in(always_in(used))
        }
    }

    /// Can an atlas of a robot with so many actions look like this?
    pub fn is_sound(&self, actions: usize) -> bool {
        let steps = self.episodes.iter().flatten();
        self.habits.headings.is_sound(actions)
            && self.drawn_with.len() == actions
            && self
                .drawn_with
                .iter()
                .flatten()
                .all(|&heading| heading < DISPLACEMENTS)
            && self.sheets.len() <= MOST_CHARTS
            && self.brought.len() <= self.sheets.len()
            && [&self.sheets, &self.brought]
                .into_iter()
                .flatten()
                .all(Sheet::is_sound)
            && self.episodes.iter().all(|steps| steps.len() <= KEPT_STEPS)
            && steps
                .clone()
                .all(|step| step.action.index() < actions && step.found.is_finite())
            && [self.slips, self.misread].iter().flatten().all(is_count)
            && (0.0..=1.0).contains(&self.habits.slip)
            && (0.0..=1.0).contains(&self.planned_slip)
            && (0.0..=1.0).contains(&self.habits.misread)
    }
}

/// How often moves slip in plans, if they seem to slip so often: in steps of a fiftieth, and as
/// `before` while that is as good. Each change makes all plans worthless.
fn slip_to_plan_with(slip: f64, before: f64) -> f64 {
    match slip < EXACT {
        true => 0.0,
        false if before > 0.0 && (slip - before).abs() < 0.02 => before,
        false => (slip * 50.0).round() / 50.0,
    }
}
