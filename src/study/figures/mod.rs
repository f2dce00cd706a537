//! Figures of a study, as SVG and PNG. Only this folder knows the drawing library.

mod ablation;
mod canvas;
mod curves;
mod histogram;
mod panels;
mod theme;

use ablation::Ablation;
use canvas::Drawing;
use curves::Curves;
use histogram::Histograms;
use panels::Panels;

use super::error::StudyError;
use super::folder::{StudyFolder, write_whole};
use super::summary::ArmRecords;

/// A figure that a study has.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The file name, without ending.
    pub name: &'static str,
    /// What it shows.
    pub caption: &'static str,
}

/// Draws the figures of a study into its folder, and tells which there are.
///
/// # Errors
/// When a figure cannot be drawn or written.
pub fn draw_figures(folder: &StudyFolder) -> Result<Vec<Picture>, StudyError> {
    let records = ArmRecords::all(folder);
    let panels = Panels::new(&records, folder.protocol().episodes);
    let mut pictures = Vec::new();
    if panels.series.len() <= theme::MOST_SERIES {
        let (name, caption) = (
            "first-optimal",
            "When the greedy policy first became globally optimal",
        );
        pictures.push(draw(folder, name, caption, &Histograms(&panels))?);
        let (name, caption) = (
            "curves",
            "The share of trials that had found an optimal policy",
        );
        pictures.push(draw(folder, name, caption, &Curves(&panels))?);
    }
    if let Some(chart) = Ablation::new(&records) {
        pictures.push(draw(
            folder,
            "ablation",
            "What each switch contributes",
            &chart,
        )?);
    }
    Ok(pictures)
}

fn draw(
    folder: &StudyFolder,
    name: &'static str,
    caption: &'static str,
    drawing: &impl Drawing,
) -> Result<Picture, StudyError> {
    let fault = |fault| StudyError::Figure {
        name: name.to_owned(),
        fault,
    };
    let (svg, png) = (
        canvas::svg(drawing).map_err(fault)?,
        canvas::png(drawing).map_err(fault)?,
    );
    write_whole(&folder.path().join(format!("{name}.svg")), svg.as_bytes())?;
    write_whole(&folder.path().join(format!("{name}.png")), &png)?;
    Ok(Picture { name, caption })
}
