//! Exports learned policies as source code for a robot, or as a table.
//!
//! The rules keep voting as in this program, but with integers. A microcontroller without floating
//! point chooses the same action. [`Policy`] finds the smallest integer sizes for which
//! this holds. Source code also converts a pose in metres to a percept.
//!
//! All formats show one `model`. Source code is rendered from a template for each language, which
//! fills in tables and constants and includes source files that are the same in every export.

mod model;
mod policy;
mod provenance;
mod templates;

use model::{Model, Source};
pub use policy::Policy;
pub use provenance::Provenance;
use strum::{IntoStaticStr, VariantArray};

/// The export formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Target {
    /// A C99 header with a table and a function, without allocation, libm or recursion.
    C99,
    /// A Python module.
    Python,
    /// A table of rules.
    Csv,
    /// One JSON document.
    Json,
}

impl Target {
    /// All targets.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Returns the text of the exported file.
    pub fn text(self, policy: &Policy, provenance: &Provenance) -> String {
        let template = match self {
            Self::C99 => "policy.h",
            Self::Python => "policy.py",
            Self::Csv => return Model::new(policy, provenance).csv(),
            Self::Json => return Model::new(policy, provenance).json(),
        };
        templates::rendered(template, &Source::new(policy, provenance))
    }
}
