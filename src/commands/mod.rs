//! The subcommands: thin layers over the library, one module each.
//!
//! | shared module | contents |
//! |---|---|
//! | `choices`, `node`, `ros_args` | arguments that several commands take |
//! | `learned`, `source` | what a run, a recording or a file of rules holds |
//! | `results`, `output` | what is printed to stdout, and output files |
//! | `terminal`, `progress` | text for people |
//! | `failure`, `interrupt` | errors, exit codes and signals |

mod choices;
pub mod config;
mod convert;
pub mod drive;
pub mod evaluate;
pub mod export;
pub mod failure;
pub mod interrupt;
mod learned;
pub mod map;
mod node;
mod output;
mod progress;
pub mod recording;
pub mod replay;
pub mod results;
pub mod robot;
pub mod ros_args;
pub mod rules;
pub mod simulate;
mod source;
pub mod study;
pub mod terminal;
pub mod train;
mod train_report;
pub mod world;
