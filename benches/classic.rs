//! The classic maze work of learning classifier systems, once: what `peers.py` times and compares.
//!
//! `cargo bench --bench classic -- [N [SEED [PROBLEMS [WORLD]]]] [KEY=VALUE]...` learns with a
//! population of N, in Maze4 or in another of the `worlds/`, and prints, as JSON, how many learning
//! steps that took and how good the greedy policy became. Settings are those of the literature,
//! without subsumption, and what is set besides. It takes no times: whoever runs it measures the
//! CPU time of the process.

use std::error::Error;
use std::path::Path;

use serde_json::json;
use xcscr::agent::{self, Agent, Explorer, Method, Setup};
use xcscr::arena::GridArena;
use xcscr::episode::{self, Start};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::{Resolved, Settings};
use xcscr::world::Maze;
use xcscr::xcs;
use xcscr::xcs::random::Stream;

const WORLDS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds");

/// The parameters of the literature; no subsumption.
fn settings(population_size: u32) -> Settings {
    let xcs = xcs::Params {
        population_size,
        dont_care: 0.4,
        epsilon_0: 1.0,
        ga_subsumption: false,
        action_set_subsumption: false,
        ..xcs::Params::default()
    };
    let reward = agent::Params {
        goal: 1000.0,
        step: 0.0,
        collision: 0.0,
        gamma: 0.71,
        ..agent::Params::default()
    };
    Settings {
        xcs,
        reward,
        ..Settings::default()
    }
}

/// What came of a run.
#[derive(Default)]
struct Tally {
    steps: u64,
    /// The steps of each exploit episode.
    exploits: Vec<u32>,
}

/// `problems` times an explore and an exploit episode, each from a random cell.
fn learn(maze: Maze, learner: &mut dyn Agent, seed: u64, problems: u32) -> Tally {
    let mut explorer = Explorer::new(1.0, Stream::new(seed, StreamName::Exploration));
    let mut starts = Stream::new(seed, StreamName::Start);
    let cells = maze.start_cells();
    let mut arena = GridArena::new(maze);
    let mut tally = Tally::default();
    for number in 1..=2 * problems {
        let explores = number % 2 == 1;
        explorer.set_probability(f64::from(u8::from(explores)));
        let start = Start {
            episode: number,
            cell: cells[starts.below(cells.len())],
            evolves: explores,
        };
        let (sensor, explorer) = (Sensor::Neighbours, &mut explorer);
        let (episode, _) = episode::run(start, &mut arena, sensor, learner, explorer, &mut ());
        tally.steps += u64::from(episode.steps);
        if !explores {
            tally.exploits.push(episode.steps);
        }
    }
    tally
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench` to the arguments.
    let words = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let (sets, words): (Vec<String>, Vec<String>) = words.partition(|word| word.contains('='));
    let number = |at: usize, default| words.get(at).map_or(Ok(default), |word| word.parse());
    let (population_size, seed, problems) = (number(0, 2000)?, number(1, 1)?, number(2, 1000)?);
    let world = words.get(3).map_or("maze4-classic", String::as_str);
    let maze = Maze::load(&Path::new(WORLDS).join(format!("{world}.json")))?;
    let Settings { xcs, reward, .. } =
        Resolved::new(&settings(population_size), &[], &sets)?.settings;
    let setup = Setup {
        xcs,
        reward,
        ..Setup::default()
    };
    let mut learner = Method::Xcs.build(maze.action_count(), 0, setup, seed.into());
    let tally = learn(maze, &mut *learner, seed.into(), problems);
    let last = &tally.exploits[tally.exploits.len().saturating_sub(100)..];
    let report = json!({
        "world": world,
        "population_size": population_size,
        "seed": seed,
        "problems": problems,
        "learning_steps": tally.steps,
        "rules": learner.rule_count(),
        "exploit_steps_in_last_100": f64::from(last.iter().sum::<u32>()) / last.len() as f64,
    });
    println!("{report}");
    Ok(())
}
