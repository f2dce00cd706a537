//! Figures of a study, as SVG and PNG. Only this module uses the drawing library.

mod ablation;
mod canvas;
mod curves;
mod episodes;
mod heat;
mod histogram;
mod panels;
mod steps;
mod theme;

use ablation::Ablation;
use canvas::Drawing;
use curves::Curves;
use episodes::Episodes;
use heat::Heat;
use histogram::Histograms;
use panels::Panels;
use steps::Steps;

use crate::page::Picture;
use crate::study::analysis::summary::{ArmRecords, ArmSummary};
use crate::study::error::StudyError;
use crate::study::store::folder::StudyFolder;

/// A figure that a study can have.
struct Subject {
    name: &'static str,
    caption: &'static str,
}

const FIRST_OPTIMAL: Subject = Subject {
    name: "first-optimal",
    caption: "When the greedy policy first became globally optimal",
};
const CURVES: Subject = Subject {
    name: "curves",
    caption: "The share of trials that had found an optimal policy",
};
const EPISODES: Subject = Subject {
    name: "episodes",
    caption: "Steps per episode",
};
const STEPS: Subject = Subject {
    name: "steps",
    caption: "Environment steps until the policy was globally optimal",
};
const HEAT: Subject = Subject {
    name: "heat",
    caption: "Optimal trials by two settings",
};
const ABLATION: Subject = Subject {
    name: "ablation",
    caption: "Contribution of each switch",
};

/// Draws the figures of a study into its folder, and returns them. `arms` are the study's
/// summaries.
///
/// # Errors
/// When a figure cannot be drawn or written.
pub fn draw_figures(folder: &StudyFolder, arms: &[ArmSummary]) -> Result<Vec<Picture>, StudyError> {
    let records = ArmRecords::all(folder);
    let panels = Panels::new(&records, folder.protocol().episodes);
    let mut pictures = Vec::new();
    if panels.series.len() <= theme::MOST_SERIES {
        pictures.push(draw(folder, FIRST_OPTIMAL, &Histograms(&panels))?);
        pictures.push(draw(folder, CURVES, &Curves(&panels))?);
        if let Some(curves) = folder.learning_curves() {
            pictures.push(draw(folder, EPISODES, &Episodes::new(&panels, &curves))?);
        }
    }
    if let Some(chart) = Steps::new(&panels, arms) {
        pictures.push(draw(folder, STEPS, &chart)?);
    }
    if let Some(chart) = Heat::new(&folder.protocol().arms, arms) {
        pictures.push(draw(folder, HEAT, &chart)?);
    }
    if let Some(chart) = Ablation::new(&records) {
        pictures.push(draw(folder, ABLATION, &chart)?);
    }
    Ok(pictures)
}

fn draw(
    folder: &StudyFolder,
    subject: Subject,
    drawing: &impl Drawing,
) -> Result<Picture, StudyError> {
    let Subject { name, caption } = subject;
    let fault = |fault| StudyError::Figure {
        name: name.to_owned(),
        fault,
    };
    let (svg, png) = (
        canvas::svg(drawing).map_err(fault)?,
        canvas::png(drawing).map_err(fault)?,
    );
    folder.write(&format!("{name}.svg"), svg.as_bytes())?;
    folder.write(&format!("{name}.png"), &png)?;
    Ok(Picture { name, caption, svg })
}
