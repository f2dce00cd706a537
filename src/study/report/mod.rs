//! What a finished study says, in words, tables and pictures.

mod document;
mod results;

use document::Block;

use super::folder::StudyFolder;
use super::summary::ArmSummary;

/// The report of a study.
#[derive(Debug, Clone)]
pub struct Report {
    blocks: Vec<Block>,
}

impl Report {
    /// The report of what is finished of a study.
    pub fn new(folder: &StudyFolder) -> Self {
        let arms = ArmSummary::all(folder);
        let blocks = vec![
            Block::Heading(format!("Study {}", folder.protocol().name)),
            Block::Table(results::table(&arms)),
        ];
        Self { blocks }
    }

    /// The report as Markdown; pictures lie beside it.
    pub fn markdown(&self) -> String {
        document::markdown(&self.blocks)
    }

    /// The report for a terminal.
    pub fn terminal(&self) -> String {
        document::terminal(&self.blocks)
    }
}
