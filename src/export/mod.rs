//! The policy out: what was learned as source code for a robot, or as a table.
//!
//! Rules keep voting as they do here, but in whole numbers, so that a microcontroller without
//! floating point chooses the same action. [`Ballot`] finds the fewest bits with which it does.

mod ballot;
mod c99;
mod data;
mod dot;
mod origin;
mod python;
mod rust;

pub use ballot::{Ballot, ExportError, Vote};
pub use origin::Origin;
use strum::{IntoStaticStr, VariantArray};

/// What a policy can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Target {
    /// A C99 header: a table and a function, without allocation, libm or recursion.
    C99,
    /// A Rust module that needs no standard library.
    Rust,
    /// A Python module.
    Python,
    /// A table of rules.
    Csv,
    /// One JSON document.
    Json,
    /// A graph for Graphviz: percepts, rules, actions.
    Dot,
}

impl Target {
    /// All targets.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The whole text of the file.
    pub fn text(self, ballot: &Ballot, origin: &Origin) -> String {
        match self {
            Self::C99 => c99::text(ballot, origin),
            Self::Rust => rust::text(ballot, origin),
            Self::Python => python::text(ballot, origin),
            Self::Csv => data::csv(ballot, origin),
            Self::Json => data::json(ballot, origin),
            Self::Dot => dot::text(ballot, origin),
        }
    }
}
