//! The comparison of two runs in one recording.

use std::path::Path;

use super::folder::RunFolder;
use super::highlights::Material;
use super::source::{Source, attached_plan, recorded_mode};
use crate::error::Error;
use crate::record::reader::Recording;
use crate::record::{self, Comparison, compare_highlights, layout};

impl Comparison {
    /// Combines the highlights of two runs side by side: segment by segment, each pair at the same
    /// time, then the drives of the learned policies. A path is the folder of a run or one of its
    /// recordings.
    ///
    /// # Errors
    /// If a path is not a finished run, or a recording is damaged.
    pub fn of(paths: [&Path; 2]) -> Result<Self, Error> {
        side_by_side([material(paths[0])?, material(paths[1])?])
    }

    /// Repeats the runs of a recorded comparison and returns the first difference as text.
    ///
    /// # Errors
    /// If the recording does not name its runs, or a run cannot be repeated.
    pub fn difference(recorded: &Recording) -> Result<Option<String>, Error> {
        let again = |side: &str| {
            let plan = attached_plan(recorded, &format!("{side}/"))?;
            Material::again(&plan, recorded_mode(recorded, side)?)
        };
        let [a, b] = layout::SIDES;
        let made = side_by_side([again(a)?, again(b)?])?;
        record::compare(recorded.bytes(), &made.bytes)
    }
}

fn side_by_side([a, b]: [Material; 2]) -> Result<Comparison, Error> {
    let (mut of_a, mut of_b) = (a.builder()?, b.builder()?);
    for number in 0..a.segments().max(b.segments()) {
        a.add_segment(number, &mut of_a)?;
        b.add_segment(number, &mut of_b)?;
        of_a.catch_up(&mut of_b)?;
    }
    a.add_drive(&mut of_a)?;
    b.add_drive(&mut of_b)?;
    of_a.catch_up(&mut of_b)?;
    compare_highlights([of_a, of_b])
}

fn material(path: &Path) -> Result<Material, Error> {
    match path.is_dir() {
        true => Material::of(&RunFolder::open(path)),
        false => {
            let source = Source::of(path)?;
            source.require_training()?;
            Material::again(&source.run.plan, source.mode)
        }
    }
}
