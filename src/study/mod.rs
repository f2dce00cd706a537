//! Studies: trials, their statistics and their reports.
//!
//! | module | contents |
//! |---|---|
//! | `protocol` | study files, and the protocol that they are frozen into |
//! | `store` | the folder of a study: the plan, and journals of finished trials |
//! | `runner` | running trials on threads, all of a study or those of a task |
//! | `custom` | custom agents in studies |
//! | `statistics` | tests and intervals, independent of mazes and learners |
//! | `analysis`, `episodes` | summaries of arms, learning curves, and tables for other programs |
//! | `report` | the report in words, tables and figures |
//! | `robustness` | a policy under conditions that it was not trained for |

mod analysis;
mod episodes;
mod error;
mod custom;
mod protocol;
mod report;
mod robustness;
mod runner;
mod statistics;
mod store;

pub use custom::Agents;
pub use protocol::{Arm, Protocol, StudyFile, StudyKey, Variant};
pub use report::{Report, report_columns};
pub use robustness::{ConditionResult, LeftOut, Robustness};
pub use runner::Watch;
pub use store::{Figures, StudyFolder, TrialRecord};
