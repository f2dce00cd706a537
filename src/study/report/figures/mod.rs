//! Figures of a study, as SVG, in the width of a column of print.

mod episodes;
mod firsts;
mod layout;
mod panels;
mod solved;

use episodes::Episodes;
use firsts::Firsts;
use layout::{Plot, figure};
use panels::Panels;
use solved::{Solved, Time};

use crate::Error;
use crate::page::Picture;
use crate::study::analysis::summary::ArmRecords;
use crate::study::store::StudyFolder;

/// Draws the figures of a study into its folder, and returns them.
///
/// # Errors
/// When a figure cannot be written.
pub fn draw_figures(
    folder: &StudyFolder,
    records: &[ArmRecords<'_>],
) -> Result<Vec<Picture>, Error> {
    let panels = Panels::new(records, folder.protocol().episodes);
    let mut pictures = Vec::new();
    let mut add = |name, caption, plot: &dyn Plot| {
        let svg = figure(name, &panels, plot).document();
        folder.write(&format!("{name}.svg"), svg.as_bytes())?;
        pictures.push(Picture { name, caption, svg });
        Ok::<_, Error>(())
    };
    add(
        "curves",
        "Share of trials that had found a globally optimal policy, by episode, with Wilson's 95 % intervals.",
        &Solved::new(&panels, Time::Episodes),
    )?;
    add(
        "curves-by-steps",
        "Share of trials that had found a globally optimal policy, by steps in the environment, with Wilson's \
         95 % intervals. A curve ends where the longest trial ended.",
        &Solved::new(&panels, Time::Steps),
    )?;
    add(
        "first-optimal",
        "First optimal episode of each trial. The numbers are the trials that found an optimal policy.",
        &Firsts::new(&panels),
    )?;
    if let Some(curves) = folder.learning_curves() {
        add(
            "episodes",
            "Mean steps of each episode, with Student's 95 % intervals.",
            &Episodes::new(&panels, &curves),
        )?;
    }
    Ok(pictures)
}
