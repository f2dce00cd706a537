//! Exports learned policies as source code for a robot, or as a table.
//!
//! The rules keep voting as in this program, but with integers. A microcontroller without floating
//! point chooses the same action. [`QuantisedPolicy`] finds the smallest integer sizes for which
//! this holds. Rules with a map are exported with their maps as a table, and with a tracker that
//! follows the robot on them (`memory`). Source code also converts a pose in metres to a percept
//! (`frame`).

mod quantised;
mod c99;
mod comments;
mod data;
mod dot;
mod frame;
mod memory;
mod provenance;
mod policy;
mod python;
mod rust;

use frame::Form;
pub use policy::Policy;
pub use provenance::Provenance;
pub use quantised::{ExportError, QuantisedPolicy, WeightedRule};
use strum::{IntoStaticStr, VariantArray};

/// The export formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Target {
    /// A C99 header with a table and a function, without allocation, libm or recursion.
    C99,
    /// A Rust module without the standard library.
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

    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Returns the text of the exported file.
    pub fn text(self, policy: &Policy, provenance: &Provenance) -> String {
        let quantised = policy.quantised();
        let form = match policy.maps() {
            None => Form::Bytes,
            Some(_) => Form::Number,
        };
        let frame = self.frame(provenance, form);
        match (self, policy.maps()) {
            (Self::C99, None) => c99::text(quantised, provenance, &frame),
            (Self::C99, Some(maps)) => memory::c99::text(quantised, maps, provenance, &frame),
            (Self::Rust, None) => rust::text(quantised, provenance) + &frame,
            (Self::Rust, Some(maps)) => memory::rust::text(quantised, maps, provenance) + &frame,
            (Self::Python, None) => python::text(quantised, provenance) + &frame,
            (Self::Python, Some(maps)) => {
                memory::python::text(quantised, maps, provenance) + &frame
            }
            (Self::Csv, _) => data::csv(quantised, provenance),
            (Self::Json, _) => data::json(policy, provenance),
            (Self::Dot, _) => dot::text(quantised, provenance),
        }
    }

    /// Returns the source code that converts a pose to a percept.
    fn frame(self, provenance: &Provenance, form: Form) -> String {
        match self {
            Self::C99 => frame::c99(provenance, form),
            Self::Rust => frame::rust(provenance, form),
            Self::Python => frame::python(provenance, form),
            Self::Csv | Self::Json | Self::Dot => String::new(),
        }
    }
}
