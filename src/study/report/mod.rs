//! What a finished study says, in words, tables and pictures.

pub(super) mod ablation;
mod comparisons;
mod document;
mod figures;
mod paper;
mod results;
mod settings;

use serde::Serialize;

pub use ablation::SwitchEffect;
pub use comparisons::Comparison;
pub use document::Table;
pub use paper::AgainstPaper;

use document::Block;

use super::analysis::summary::{ArmRecords, ArmSummary};
use super::error::StudyError;
use super::protocol::Protocol;
use super::report::figures::{Picture, draw_figures};
use super::store::folder::StudyFolder;

/// The report of a study.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    study: String,
    plan: String,
    version: String,
    seed: u64,
    trials: usize,
    episodes: u32,
    /// What came out, per arm.
    pub arms: Vec<ArmSummary>,
    /// Next to the paper's numbers.
    pub against_paper: Vec<AgainstPaper>,
    /// Method against method.
    pub comparisons: Vec<Comparison>,
    /// What each switch contributes.
    pub switches: Vec<SwitchEffect>,
    #[serde(skip)]
    results: Table,
    #[serde(skip)]
    letters: Option<String>,
    #[serde(skip)]
    settings: String,
    #[serde(skip)]
    settings_that_matter: String,
    #[serde(skip)]
    pictures: Vec<Picture>,
}

impl Report {
    /// The report of what is finished of a study.
    pub fn new(folder: &StudyFolder) -> Self {
        let arms = ArmRecords::all(folder);
        let Protocol {
            version,
            name,
            seed,
            trials,
            episodes,
            ..
        } = folder.protocol().clone();
        let summaries = ArmSummary::all(folder);
        let specs = &folder.protocol().arms;
        Self {
            study: name,
            plan: folder.plan().to_owned(),
            version,
            seed,
            trials,
            episodes,
            results: results::table(specs, &summaries),
            letters: results::letters_legend(&results::letters(specs)),
            arms: summaries,
            against_paper: AgainstPaper::all(&arms, folder.protocol()),
            comparisons: Comparison::all(&arms),
            switches: SwitchEffect::all(&arms),
            settings: settings::sentences(folder.protocol()),
            settings_that_matter: paper::settings_that_matter(&arms),
            pictures: Vec::new(),
        }
    }

    /// Draws the figures and writes `report.md` into the folder of the study.
    ///
    /// # Errors
    /// When a figure cannot be drawn, or a file not be written.
    pub fn write(&mut self, folder: &StudyFolder) -> Result<(), StudyError> {
        self.pictures = draw_figures(folder)?;
        let text = format!(
            "# Study {}\n\n{}",
            self.study,
            document::markdown(&self.blocks())
        );
        folder.write("report.md", text.as_bytes())
    }

    /// The report for a terminal.
    pub fn terminal(&self) -> String {
        document::terminal(&self.blocks())
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = vec![
            Block::Text(self.introduction()),
            Block::Table(self.results.clone()),
        ];
        blocks.extend(self.letters.clone().map(Block::Text));
        blocks.push(Block::Text(results::LEGEND.to_owned()));
        blocks.extend(results::fewest_steps(&self.arms).map(Block::Text));
        self.add_paper(&mut blocks);
        self.add_comparisons(&mut blocks);
        self.add_switches(&mut blocks);
        let pictures = self.pictures.iter();
        blocks.extend(pictures.map(|one| Block::Picture(one.name, one.caption.to_owned())));
        blocks
    }

    fn introduction(&self) -> String {
        let Self {
            study,
            plan,
            version,
            seed,
            trials,
            episodes,
            settings,
            ..
        } = self;
        format!(
            "Study **{study}**: {trials} trials of {episodes} episodes each, root seed {seed}, \
             xcscr {version}, plan {plan}. {settings}"
        )
    }

    fn add_paper(&self, blocks: &mut Vec<Block>) {
        if !self.against_paper.is_empty() {
            blocks.extend([
                Block::Heading("Next to the paper".to_owned()),
                Block::Table(paper::table(&self.against_paper)),
                Block::Text(paper::verdict(&self.against_paper)),
                Block::Text(self.settings_that_matter.clone()),
            ]);
        }
    }

    fn add_comparisons(&self, blocks: &mut Vec<Block>) {
        if !self.comparisons.is_empty() {
            blocks.extend([
                Block::Heading("What the data can decide".to_owned()),
                Block::Table(comparisons::table(&self.comparisons)),
                Block::Text(comparisons::LEGEND.to_owned()),
                Block::Text(comparisons::verdict(&self.comparisons)),
            ]);
        }
        if !self.against_paper.is_empty() {
            blocks.push(Block::Text(comparisons::paper_maze4()));
        }
    }

    fn add_switches(&self, blocks: &mut Vec<Block>) {
        if !self.switches.is_empty() {
            blocks.extend([
                Block::Heading("What each switch contributes".to_owned()),
                Block::Table(ablation::table(&self.switches)),
                Block::Text(ablation::verdict(&self.switches)),
            ]);
        }
    }
}
