//! What a step of learning costs as the world grows, of every method, with clean and with noisy
//! percepts.
//!
//! `cargo bench --bench scale` prints, as rows of tables, microseconds of CPU per step on the grid, in
//! mazes of winding passages whose cells all look different (the sensor `position`), and in brackets the rules or stored pairs at the
//! end; with `1%`, each bit of a percept is flipped with that chance. A trial ends after 20,000 steps
//! or 10 s. `cargo bench --bench scale -- METHOD SIZE FLIPS STEPS` runs one of them, for a profile; its
//! flips count in parts of 10,000.

mod clock;

use std::error::Error;

use clock::cpu_ns;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Trial};
use xcscr::world::{MazeKind, Recipe};

const SIZES: [u16; 6] = [8, 16, 32, 64, 128, 256];
const FLIPS: [f64; 2] = [0.0, 0.01];
const MOST_STEPS: u64 = 20_000;
const MOST_NS: u64 = 10_000_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench` to the arguments.
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    if let [method, size, flips, steps] = &words[..] {
        let method = method_called(method).ok_or("there is no such method")?;
        let rate = flips.parse::<f64>()? / 10_000.0;
        println!("{}", cost(method, size.parse()?, rate, steps.parse()?)?);
        return Ok(());
    }
    for rate in FLIPS {
        let heads = SIZES.map(|size| format!(" {size} |")).concat();
        println!("| {}% |{heads}", 100.0 * rate);
        for &method in Method::ALL {
            let cells = SIZES
                .iter()
                .map(|&size| cost(method, size, rate, MOST_STEPS));
            let cells: Vec<String> = cells.collect::<Result<_, _>>()?;
            println!("| `{}` | {} |", method.name(), cells.join(" | "));
        }
    }
    Ok(())
}

fn method_called(name: &str) -> Option<Method> {
    Method::ALL
        .iter()
        .copied()
        .find(|method| method.name() == name)
}

/// Microseconds per step, and the rules.
fn cost(method: Method, size: u16, rate: f64, most: u64) -> Result<String, Box<dyn Error>> {
    let recipe = Recipe {
        kind: MazeKind::Dfs,
        size,
        seed: 1,
    };
    let mut plan = Plan::new(recipe.maze()?)
        .method(method)
        .arena(ArenaKind::Grid)
        .sensor(Sensor::Position)
        .episodes(10_000);
    plan.config.settings.sensor.flip_probability = rate;
    let begin = cpu_ns()?;
    let mut trial = Trial::new(plan)?;
    while trial.progress().steps < most && cpu_ns()? - begin < MOST_NS {
        let _ = trial.run_episode(&mut ());
    }
    let us = (cpu_ns()? - begin) as f64 / 1000.0 / trial.progress().steps as f64;
    Ok(format!("{us:.1} ({})", trial.method().rule_count()))
}
