//! The report of a study, in words, tables and figures.

mod comparisons;
mod conclusions;
mod figures;
mod results;
mod settings;

use std::io;

use serde::Serialize;

use comparisons::Comparison;
pub use results::columns as report_columns;

use crate::page::{self, Block, Picture};

use super::analysis::summary::{ArmRecords, ArmSummary};
use super::analysis::tables;
use super::protocol::Protocol;
use super::report::figures::draw_figures;
use super::store::StudyFolder;
use crate::Error;

/// The analysis of a study, made once, as tables for other programs and as a report. As JSON, it contains all figures:
/// the results per arm, and the comparisons of methods.
#[derive(Debug, Clone, Serialize)]
pub struct Report<'a> {
    study: &'a str,
    plan: &'a str,
    version: &'a str,
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
    folder: &'a StudyFolder,
    #[serde(skip)]
    records: Vec<ArmRecords<'a>>,
    #[serde(skip)]
    pictures: Vec<Picture>,
}

/// The contents of `summary.json`.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    study: &'a str,
    plan: &'a str,
    version: &'a str,
    seed: u64,
    episodes: u32,
    arms: &'a [ArmSummary],
}

fn is_zero(missing: &usize) -> bool {
    *missing == 0
}

impl<'a> Report<'a> {
    /// Analyses the finished trials of a study. The report of an incomplete study has the table
    /// only: tests that are repeated until they are significant have too many false positives.
    pub fn new(folder: &'a StudyFolder) -> Self {
        let protocol = folder.protocol();
        let missing = folder.missing().len();
        let records = ArmRecords::all(folder);
        let summary = |records| ArmSummary::new(records, protocol.seed);
        let is_tested = |arm: &&ArmRecords<'_>| missing == 0 && !arm.needs_memory;
        let tested: Vec<_> = records.iter().filter(is_tested).cloned().collect();
        Self {
            study: &protocol.name,
            plan: folder.plan(),
            version: &protocol.version,
            seed: protocol.seed,
            trials: protocol.trials,
            episodes: protocol.episodes,
            missing,
            arms: records.iter().map(summary).collect(),
            comparisons: Comparison::all(&tested, protocol.reference_method()),
            folder,
            records,
            pictures: Vec::new(),
        }
    }

    fn protocol(&self) -> &'a Protocol {
        self.folder.protocol()
    }

    /// Writes `trials.csv`, `summary.json` and the report into the folder of the study.
    ///
    /// # Errors
    /// When a figure cannot be drawn, or a file cannot be written.
    pub fn write(&mut self) -> Result<(), Error> {
        let trials = |file: &mut dyn io::Write| tables::write_trials(self.folder, file);
        self.folder.write_with("trials.csv", trials)?;
        let summary = Summary {
            study: self.study,
            plan: self.plan,
            version: self.version,
            seed: self.seed,
            episodes: self.episodes,
            arms: &self.arms,
        };
        let summary = crate::disk::json(&summary);
        self.folder.write("summary.json", summary.as_bytes())?;
        self.write_report()
    }

    /// Draws the figures, and writes `report.md` and `report.html`.
    pub(in crate::study) fn write_report(&mut self) -> Result<(), Error> {
        self.pictures = draw_figures(self.folder, &self.records)?;
        self.folder.write("report.md", self.markdown().as_bytes())?;
        self.folder.write("report.html", self.html().as_bytes())
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
        let arms = &self.protocol().arms;
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
        let settings = settings::sentences(self.protocol());
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
        let letters = results::letters(&self.protocol().arms);
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
        limits.extend(comparisons::of_searches(&self.protocol().arms));
        limits.extend(conclusions::power(self.trials, &self.comparisons));
        limits
    }
}
