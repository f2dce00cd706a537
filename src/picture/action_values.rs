//! Draws the value of every action at some stages of learning, as Figures 2 and 5 of the paper do.

use std::collections::BTreeSet;

use super::chart::{Anchor, Axis, Chart, Line, Point, label, sample, thousands};
use super::drawing::{
    ARROW, FAINT, HEAD, INK, MARGIN, PAPER, Plane, VISITED, arrow, block, cell_px, words,
};
use super::policy_picture::{Margin, Moment, PolicyPicture};
use super::svg::{Drawing, Element};
use crate::agent::Sharing;
use crate::record::colours::{ABOVE, BELOW};
use crate::world::{Cell, Direction};

/// The colour of the best actions on the greedy path.
const POLICY: u32 = 0x128a3e;
/// The colour of the cell in which the episode ended.
const END: u32 = 0x8f97a3;

/// Height of the captions below the mazes, and of the legend, in pixels.
const CAPTIONS: f64 = 66.0;
const LEGEND: f64 = 34.0;
/// Height of the chart of margins with its heading and its numbers.
const MARGINS: f64 = 198.0;
/// Least width of a panel, so that its caption fits.
const LEAST_PANEL: f64 = 300.0;
/// Least width of a picture with a chart.
const LEAST_WIDTH: f64 = 640.0;
/// Length of the arrow of the greatest value of a panel, in cells.
const LONGEST: f64 = 0.47;
/// Least length of an arrow, in cells, so that its colour is visible.
const SHORTEST: f64 = 0.14;
/// The lines of the chart of margins.
const MEAN: Line = Line {
    colour: 0x0072b2,
    width: 1.6,
    dashes: "",
};
const LEAST: Line = Line {
    colour: 0xd55e00,
    width: 1.2,
    dashes: "5 2",
};
const ZERO: Line = Line {
    colour: FAINT,
    width: 1.0,
    dashes: "",
};
const STAGE: Line = Line {
    colour: FAINT,
    width: 0.8,
    dashes: "2 2",
};

/// Draws one maze for each stage, side by side, and below them the growth of the margins of optimal actions.
pub(super) fn draw(picture: &PolicyPicture) -> Drawing {
    let (maze, panels) = (&picture.maze, picture.moments.len());
    let cell = cell_px(maze, panels);
    let maze_px = f64::from(maze.width()) * cell;
    let panel = maze_px.max(LEAST_PANEL);
    let has_chart = picture.margins.len() > 1;
    let least = if has_chart { LEAST_WIDTH } else { 0.0 };
    let width = (MARGIN + panels as f64 * (panel + MARGIN)).max(least);
    let below = HEAD + f64::from(maze.height()) * cell;
    let top_of_chart = below + CAPTIONS + LEGEND;
    let height = top_of_chart + if has_chart { MARGINS } else { 0.0 };
    let mut elements = vec![block(0.0, 0.0, width, height, PAPER)];
    let title = format!("{}: the value of every action", picture.title);
    elements.push(words(MARGIN, 26.0, 17.0, INK, title));
    elements.push(words(MARGIN, 46.0, 13.0, FAINT, shared(picture.sharing)));
    let mut panel_left = MARGIN;
    for moment in &picture.moments {
        let left = panel_left + ((panel - maze_px) / 2.0).floor();
        let plane = Plane { maze, cell, left };
        elements.extend(plane.ground());
        elements.extend(plane.values(moment));
        for (line, (colour, text)) in captions(moment).into_iter().enumerate() {
            let y = below + 20.0 + 17.0 * line as f64;
            elements.push(words(panel_left, y, 13.0, colour, text));
        }
        panel_left += panel + MARGIN;
    }
    elements.extend(legend(below + CAPTIONS + 14.0, width));
    if has_chart {
        elements.extend(margins(picture, top_of_chart, width));
    }
    Drawing {
        width: width as u32,
        height: height as u32,
        title: picture.title.clone(),
        definitions: ARROW,
        elements,
    }
}

/// Draws the margins of optimal actions by episode, with the stages.
fn margins(picture: &PolicyPicture, top: f64, width: f64) -> Vec<Element> {
    let all = &picture.margins;
    let line = |height: fn(&Margin) -> f64| -> Vec<Point> {
        let point = |margin: &Margin| (f64::from(margin.episode), height(margin));
        all.iter().map(point).collect()
    };
    let (means, leasts) = (line(|one| one.mean), line(|one| one.least));
    let last = means.last().map_or(1.0, |point| point.0);
    let low = leasts.iter().map(|point| point.1).fold(0.0, f64::min);
    let high = means.iter().map(|point| point.1).fold(0.0, f64::max);
    let chart = Chart {
        left: MARGIN + 40.0,
        top: top + 52.0,
        width: width - 2.0 * MARGIN - 40.0,
        height: MARGINS - 52.0 - 36.0,
        x: Axis::linear(0.0, last),
        y: Axis::linear(low, high),
    };
    let heading = "stability: value of the optimal action minus that of the best other action, along the shortest path";
    let mut shapes = vec![words(MARGIN, top + 14.0, 13.0, INK, heading)];
    let key = top + 34.0;
    for (x, line, text) in [
        (MARGIN + 40.0, MEAN, "mean of its cells"),
        (
            MARGIN + 200.0,
            LEAST,
            "least of its cells; above 0: the greedy path is a shortest one",
        ),
    ] {
        shapes.push(sample((x, key - 4.0), 26.0, line));
        shapes.push(words(x + 32.0, key, 12.0, INK, text));
    }
    shapes.extend(chart.frame(11.0, true, thousands));
    for moment in &picture.moments {
        let episode = f64::from(moment.episode.episode);
        let ends = [(episode, low), (episode, high)];
        shapes.push(chart.curve(&ends, STAGE));
        let at = (chart.at(ends[1]).0, chart.top - 2.0);
        let letter = moment.stage.map_or("", |stage| stage.name().0);
        shapes.push(label(at, 11.0, Anchor::Middle, letter.to_owned()));
    }
    shapes.push(chart.curve(&[(0.0, 0.0), (last, 0.0)], ZERO));
    shapes.push(chart.curve(&leasts, LEAST));
    shapes.push(chart.curve(&means, MEAN));
    let at = (chart.left + chart.width / 2.0, top + MARGINS - 8.0);
    shapes.push(label(at, 12.0, Anchor::Middle, "episode".to_owned()));
    shapes
}

impl Plane<'_> {
    /// Returns the visited cells, and an arrow for each action in each free cell.
    fn values(&self, moment: &Moment) -> Vec<Element> {
        let index = |cell: &Cell| self.maze.index(*cell);
        let visited: BTreeSet<usize> = moment.visited.iter().map(index).collect();
        let end = moment.visited.last().map(index);
        let fill = |cell| match self.maze.index(cell) {
            at if Some(at) == end => END,
            at if visited.contains(&at) => VISITED,
            _ => PAPER,
        };
        let cells = self.maze.free_cells();
        let mut shapes: Vec<Element> = cells.map(|cell| self.tile(cell, 0.5, fill(cell))).collect();
        shapes.extend(self.true_walls());
        let on_path: BTreeSet<usize> = moment.greedy_path.iter().map(index).collect();
        let greatest = greatest(moment).max(f64::MIN_POSITIVE);
        for (cell, values) in moment.policy.cells() {
            let directions = self.maze.moves().directions().iter();
            for (&direction, &value) in directions.zip(values.as_slice()) {
                let Some(value) = value.filter(|&value| value != 0.0) else {
                    continue;
                };
                let is_best = Some(value) == values.greatest();
                let colour = match () {
                    () if is_best && on_path.contains(&index(cell)) => POLICY,
                    () if value < 0.0 => BELOW,
                    () => ABOVE,
                };
                let length = (LONGEST * (value.abs() / greatest).powf(0.25)).max(SHORTEST);
                shapes.push(arrow(
                    self.centre(*cell),
                    direction,
                    length * self.cell,
                    colour,
                ));
            }
        }
        shapes.extend(self.letters());
        shapes
    }
}

/// Returns the greatest magnitude of a value.
fn greatest(moment: &Moment) -> f64 {
    let cells = moment.policy.cells();
    let values = cells.flat_map(|(_, values)| values.as_slice().iter().flatten().copied());
    values.map(f64::abs).fold(0.0, f64::max)
}

/// Returns the lines below a panel, with their colours.
fn captions(moment: &Moment) -> Vec<(u32, String)> {
    let scale = format!(
        "longest arrow: {:.0}; length: fourth root",
        greatest(moment)
    );
    let stage = moment.stage.map(|stage| {
        let (letter, name) = stage.name();
        (INK, format!("{letter}: {name}"))
    });
    let lines = [(FAINT, moment.result()), (FAINT, scale)];
    stage.into_iter().chain(lines).collect()
}

/// Says how the sharing of rewards shapes the values of the policy.
fn shared(sharing: Option<Sharing>) -> &'static str {
    match sharing {
        None => "",
        Some(Sharing::Even) => {
            "Every step of an episode gets the same share of its reward (Eq. 8): the values of a policy become equal."
        }
        Some(Sharing::Discounted) => {
            "Steps further from the goal get a smaller share (Eq. 9): the values of a policy grow toward the goal."
        }
    }
}

fn legend(y: f64, width: f64) -> Vec<Element> {
    let entries = [
        (POLICY, "best action on the greedy path"),
        (ABOVE, "above 0"),
        (BELOW, "below 0"),
    ];
    let mut shapes = Vec::new();
    let mut x = MARGIN;
    for (colour, text) in entries {
        shapes.push(arrow((x, y - 4.5), Direction::East, 26.0, colour));
        shapes.push(words(x + 32.0, y, 12.0, INK, text));
        x += 52.0 + 6.6 * text.len() as f64;
    }
    for (fill, text) in [(VISITED, "visited"), (END, "end of the episode")] {
        // A single panel is too narrow for the whole legend.
        if x + 24.0 + 6.6 * text.len() as f64 > width {
            break;
        }
        shapes.push(block(x, y - 13.0, 17.0, 17.0, fill));
        shapes.push(words(x + 23.0, y, 12.0, INK, text));
        x += 43.0 + 6.6 * text.len() as f64;
    }
    shapes
}
