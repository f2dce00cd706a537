//! Figures of a study, as SVG. Only this module uses the drawing library.

mod canvas;
mod curves;
mod episodes;
mod panels;
mod theme;

use canvas::Drawing;
use curves::Curves;
use episodes::Episodes;
use panels::Panels;

use crate::page::Picture;
use crate::study::analysis::summary::ArmRecords;
use crate::study::store::StudyFolder;
use crate::{Error, ErrorKind};

/// Draws the figures of a study into its folder, and returns them.
///
/// # Errors
/// When a figure cannot be drawn or written.
pub fn draw_figures(
    folder: &StudyFolder,
    records: &[ArmRecords<'_>],
) -> Result<Vec<Picture>, Error> {
    let panels = Panels::new(records, folder.protocol().episodes);
    let mut pictures = Vec::new();
    let mut add = |name, caption, drawing: &dyn Drawing| {
        pictures.push(draw(folder, name, caption, drawing)?);
        Ok::<_, Error>(())
    };
    if panels.series.len() <= theme::MOST_SERIES {
        let caption = "The share of trials that had found an optimal policy";
        add("curves", caption, &Curves(&panels))?;
        if let Some(curves) = folder.learning_curves() {
            let chart = Episodes::new(&panels, &curves);
            add("episodes", "Steps per episode", &chart)?;
        }
    }
    Ok(pictures)
}

fn draw(
    folder: &StudyFolder,
    name: &'static str,
    caption: &'static str,
    drawing: &dyn Drawing,
) -> Result<Picture, Error> {
    let fault = |fault: String| ErrorKind::Internal.error(format!("cannot draw {name}: {fault}"));
    let svg = canvas::svg(drawing).map_err(fault)?;
    folder.write(&format!("{name}.svg"), svg.as_bytes())?;
    Ok(Picture { name, caption, svg })
}
