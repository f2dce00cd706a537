//! The classic Maze4 work of learning classifier systems, once: what `peers.py` times.
//!
//! `cargo bench --bench classic -- N SEED [PROBLEMS]` learns with a population of N and prints, as
//! JSON, how many learning steps that took and how good the greedy policy became. It takes no
//! times: whoever runs it measures the CPU time of the process.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

use serde_json::json;
use xcscr::episode::{self, Episode, Learned, Observer};
use xcscr::reward::{self, Method};
use xcscr::sensor::Sensor;
use xcscr::study::{ArenaKind, Config, Plan, Settings, Trial};
use xcscr::world::Maze;
use xcscr::xcs;

const WORLD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/maze4-classic.json");

/// Adds up the steps of the exploit episodes among the last 200.
struct LastExploits {
    from: u32,
    steps: u32,
    episodes: u32,
}

impl Observer for LastExploits {
    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        if episode.episode > self.from && episode.explored == 0 {
            self.steps += episode.steps;
            self.episodes += 1;
        }
        ControlFlow::Continue(())
    }
}

fn settings(population_size: u32) -> Settings {
    Settings {
        xcs: xcs::Params {
            population_size,
            dont_care: 0.4,
            epsilon_0: 1.0,
            ga_subsumption: false,
            action_set_subsumption: false,
            ..xcs::Params::default()
        },
        reward: reward::Params {
            goal: 1000.0,
            step: 0.0,
            collision: 0.0,
            gamma: 0.71,
            ..reward::Params::default()
        },
        episode: episode::Params {
            alternate: true,
            ..episode::Params::default()
        },
        ..Settings::default()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench` to the arguments.
    let numbers = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let numbers: Vec<u32> = numbers.map(|arg| arg.parse()).collect::<Result<_, _>>()?;
    let number = |at: usize, default| numbers.get(at).copied().unwrap_or(default);
    let (population_size, seed, problems) = (number(0, 2000), number(1, 1), number(2, 1000));
    let config = Config {
        version: String::new(),
        method: Method::Xcs,
        arena: ArenaKind::Grid,
        sensor: Sensor::Neighbours,
        episodes: 2 * problems,
        seed: seed.into(),
        settings: settings(population_size),
    };
    let maze = Maze::load(Path::new(WORLD))?;
    let mut trial = Trial::new(Plan { maze, config })?;
    let mut exploits = LastExploits {
        from: (2 * problems).saturating_sub(200),
        steps: 0,
        episodes: 0,
    };
    let _ = trial.run(&mut exploits);
    let report = json!({
        "population_size": population_size,
        "seed": seed,
        "problems": problems,
        "learning_steps": trial.progress().steps,
        "rules": trial.method().rule_count(),
        "exploit_steps_at_end": f64::from(exploits.steps) / f64::from(exploits.episodes),
    });
    println!("{report}");
    Ok(())
}
