//! The report of a study, in words, tables and figures.

mod comparisons;
mod conclusions;
mod figures;
mod results;
mod settings;

use serde::Serialize;

use comparisons::Comparison;

use crate::page::{self, Block, Picture};

use super::analysis::summary::{ArmRecords, ArmSummary};
use super::protocol::Protocol;
use super::report::figures::draw_figures;
use super::store::StudyFolder;
use crate::Error;

/// The report of a study. As JSON, it contains all figures: the results per arm, and the
/// comparisons of methods.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    study: String,
    plan: String,
    version: String,
    seed: u64,
    trials: usize,
    episodes: u32,
    /// Number of unfinished trials. If there are any, nothing is tested.
    #[serde(skip_serializing_if = "is_zero")]
    missing: usize,
    /// The results per arm.
    arms: Vec<ArmSummary>,
    /// The comparisons of methods.
    comparisons: Vec<Comparison>,
    #[serde(skip)]
    protocol: Protocol,
    #[serde(skip)]
    pictures: Vec<Picture>,
}

fn is_zero(missing: &usize) -> bool {
    *missing == 0
}

impl Report {
    /// Creates the report of the finished trials of a study. An incomplete study has the table
    /// only: tests that are repeated until they are significant have too many false positives.
    pub fn new(folder: &StudyFolder) -> Self {
        let missing = folder.missing().len();
        let mut tested = ArmRecords::all(folder);
        if missing > 0 {
            tested.clear();
        }
        tested.retain(|arm| !arm.needs_memory);
        let protocol = folder.protocol();
        Self {
            study: protocol.name.clone(),
            plan: folder.plan().to_owned(),
            version: protocol.version.clone(),
            seed: protocol.seed,
            trials: protocol.trials,
            episodes: protocol.episodes,
            missing,
            arms: ArmSummary::all(folder),
            comparisons: Comparison::all(&tested, protocol.reference_method()),
            protocol: protocol.clone(),
            pictures: Vec::new(),
        }
    }

    /// Draws the figures and writes `report.md` and `report.html` into the folder of the study.
    ///
    /// # Errors
    /// When a figure cannot be drawn, or a file cannot be written.
    pub fn write(&mut self, folder: &StudyFolder) -> Result<(), Error> {
        self.pictures = draw_figures(folder)?;
        folder.write("report.md", self.markdown().as_bytes())?;
        folder.write("report.html", self.html().as_bytes())
    }

    /// Formats the report for a terminal.
    pub fn terminal(&self) -> String {
        page::terminal(&self.blocks())
    }

    /// Formats the report as Markdown. Its figures are the files written by [`Self::write`].
    pub fn markdown(&self) -> String {
        let blocks = page::markdown(&self.blocks());
        format!("# {}\n\n{blocks}", page::without_tags(&self.title()))
    }

    /// Formats the report as one self-contained page, with the figures if they are drawn.
    pub fn html(&self) -> String {
        page::html(&self.title(), &self.blocks())
    }

    fn title(&self) -> String {
        format!("Study {}", self.study)
    }

    /// Returns the sections of the report, in order.
    fn blocks(&self) -> Vec<Block> {
        let arms = &self.protocol.arms;
        let results = results::table(arms, &self.arms);
        let legend = results::legend(&results);
        let mut blocks = vec![
            Block::Heading("Setup".to_owned()),
            Block::Text(self.introduction()),
        ];
        blocks.extend([Block::Heading("Table".to_owned()), Block::Table(results)]);
        blocks.extend(results::letters_legend(&results::letters(arms)).map(Block::Text));
        blocks.push(Block::Text(legend));
        if !self.pictures.is_empty() {
            blocks.push(Block::Heading("Figures".to_owned()));
            blocks.extend(self.pictures.iter().cloned().map(Block::Picture));
        }
        let tests = self.tests();
        if !tests.is_empty() {
            blocks.push(Block::Heading("Tests".to_owned()));
            blocks.extend(tests);
        }
        blocks.push(Block::Heading("Limitations".to_owned()));
        blocks.extend(self.limits().into_iter().map(Block::Text));
        blocks
    }

    fn introduction(&self) -> String {
        let Self {
            plan,
            version,
            seed,
            trials,
            episodes,
            missing,
            ..
        } = self;
        let settings = settings::sentences(&self.protocol);
        let so_far = match missing {
            0 => String::new(),
            _ => format!(
                "The study is not finished: {missing} of {} trials are missing. The table has the \
                 others, and the tests are left out. ",
                trials * self.arms.len()
            ),
        };
        format!(
            "{so_far}{trials} trials of {episodes} episodes each, root seed {seed}, xcscr {version}, plan \
             {plan}. {settings}"
        )
    }

    /// Returns the table of tests, and what they decide.
    fn tests(&self) -> Vec<Block> {
        if self.comparisons.is_empty() {
            return Vec::new();
        }
        let letters = results::letters(&self.protocol.arms);
        vec![
            Block::Subheading("Pairwise comparisons".to_owned()),
            Block::Table(comparisons::table(&self.comparisons, &letters)),
            Block::Text(comparisons::LEGEND.to_owned()),
            Block::Text(conclusions::decided(&self.comparisons)),
        ]
    }

    /// Describes what the data leave open.
    fn limits(&self) -> Vec<String> {
        let mut limits = vec![results::limits(&self.arms, self.episodes)];
        limits.extend(conclusions::undecided(&self.comparisons));
        limits.extend(comparisons::of_searches(&self.protocol.arms));
        limits.extend(conclusions::power(self.trials, &self.comparisons));
        limits
    }
}
