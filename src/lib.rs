//! A mobile robot in a physics-simulated maze learns readable rules, and every episode can be
//! replayed.
//!
//! The robot perceives the cells around it, chooses a direction, and drives there or hits a wall. It
//! learns condition-action rules from what follows. The published methods are classifier systems: XCS
//! and the reward methods of XCSCR (Zhang, Browne and Carnegie 2019). The default method is `xcscr`;
//! `xcscr-plus` adds a learned model, which leads exploration and repairs the rules.
//!
//! # Data flow
//! ```text
//!  world file ─▶ world ─▶ arena ─▶ sensor ─▶ agent ─▶ action ─▶ arena ...
//!                (Maze)   (View)   (Percept)    │              (Outcome)
//!                             │                xcs: [P] ⊇ [M] ⊇ [A]
//!                             ▼
//!     trial ─▶ episode ─▶ Observer: record (MCAP), progress, tests
//!       ▲                               ▲
//!     study: many trials                run: one recorded, resumable trial in a folder
//!       └─▶ statistics ─▶ report
//! ```
//!
//! # Where things are
//! | crate or module | contents |
//! |---|---|
//! | [`xcs`] | the classifier system, for any environment |
//! | `xcscr_sensing` | sensor models and the onboard computer |
//! | [`world`], [`arena`], [`sensor`] | the robot, from `xcscr_robot`: mazes, where it acts, what it perceives |
//! | [`agent`], [`episode`], [`trial`] | the learner, from `xcscr_learner`: methods, the loop, one trial |
//! | [`record`], [`disk`] | from `xcscr_recording`: episodes as MCAP files, their reader, atomic writes and folder locks |
//! | [`page`], [`export`], [`picture`] | policies as HTML, as code and data, as pictures |
//! | [`drive`] | a policy drives a robot that is known only by its messages; with the feature `ros2`, on ROS 2 |
//! | [`run`] | recorded runs in a folder |
//! | [`replay`] | a page that plays a recording, and a server for viewers |
//! | [`study`] | many trials, statistics, reports |
//!
//! The modules of this crate are listed in the order of their layers: a module uses only modules above it.
//!
//! A new sensor goes to `crates/robot/src/sensor/`, a new agent to `crates/learner/src/agent/`, a new topic to
//! `crates/recording/src/topics/`, a new export target to `src/export/`, a new command to `src/commands/`. CONTRIBUTING.md walks
//! through each.
//!
//! # Terms
//! | term | meaning |
//! |---|---|
//! | percept, action | what the robot perceives, a bit string; what it can do, a number |
//! | step | sense, choose, act, update: one move or one collision |
//! | episode | from a start cell until a goal is reached or the step threshold is hit |
//! | trial | a fresh learner, run for a number of episodes from one seed |
//! | rule | a macro-classifier: condition, action, prediction, error, fitness, numerosity, experience |
//! | \[P\], \[M\], \[A\], \[R\] | population, match set, action set, reward stack |
//! | action value | the fitness-weighted prediction of an action (Eq. 6) |
//! | globally optimal | from the start, every best action follows a shortest path, to the goal |
//!
//! Equations and algorithms are numbered as in the XCSCR paper, "XCS with Combined Reward Method
//! (XCSCR) for Policy Search in Multistep Problems".
//!
//! # Example
//! ```
//! use xcscr::{agent::Method, trial::Plan, world::Maze};
//!
//! let world = r######"{ "rows": ["#####", "#S..#", "###G#", "#####"] }"######;
//! let maze = Maze::from_json(world.as_bytes(), "corner.json")?;
//! let trial = Plan::new(maze).method(Method::Xcscr).episodes(30).seed(1).run()?;
//! assert!(trial.progress().optimal);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

// In order of their layers: a module names only modules above it.
pub mod page;
pub mod export;
pub mod picture;
pub mod replay;
pub mod drive;
#[cfg(feature = "ros2")]
pub mod ros2;
pub mod run;
pub mod study;

pub use xcs;
#[doc(inline)]
pub use xcscr_learner::{agent, episode, trial};
#[doc(inline)]
pub use xcscr_recording::{self as record, Error, ErrorKind, disk};
#[doc(inline)]
pub use xcscr_robot::{arena, sensor, streams, world};
