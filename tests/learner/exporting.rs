//! Exported policies are compiled or run as their users would, and choose as the learner does.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;
use xcscr::agent::{Estimator, Knowledge, Method};
use xcscr::export::{ExportError, Policy, Provenance, Target};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept};

use crate::kit::program::{ended, xcscr};
use crate::kit::trial::on_the_grid;

/// Stands for `no rule matches` in what the programs print.
const NONE: u8 = 255;

/// Reads percepts from standard input until its end, and writes one byte for each.
const C_MAIN: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    uint8_t percept[XCSCR_PERCEPT_BYTES];
    while (fread(percept, 1, sizeof percept, stdin) == sizeof percept) {
        putchar((uint8_t)xcscr_decide(percept));
    }
    return 0;
}
"#;

const RUST_MAIN: &str = r"
use std::io::{Read, Write};
mod policy;

fn main() {
    let mut percepts = Vec::new();
    std::io::stdin().read_to_end(&mut percepts).unwrap();
    let chunks = percepts.chunks_exact(policy::PERCEPT_BYTES);
    let chosen: Vec<u8> = chunks.map(|p| policy::decide(p.try_into().unwrap()).unwrap_or(255)).collect();
    std::io::stdout().write_all(&chosen).unwrap();
}
";

/// Percepts as text, one a line, for Python.
const PYTHON_MAIN: &str = r"
import sys
import policy
for line in sys.stdin:
    action = policy.decide(line.strip())
    sys.stdout.buffer.write(bytes([255 if action is None else action]))
";

/// What a method learned.
pub struct Learned {
    pub plan: Plan,
    pub knowledge: Knowledge,
}

impl Learned {
    pub fn new(world: &str, method: Method, sensor: Sensor) -> Self {
        let mut plan = on_the_grid(world, method).sensor(sensor);
        plan.config.settings.plus.estimator = Estimator::Percept;
        let trial = plan.episodes(60).run().unwrap();
        Self {
            plan: trial.plan().clone(),
            knowledge: trial.method().knowledge(),
        }
    }

    fn width(&self) -> usize {
        self.plan.config.sensor.width(&self.plan.maze)
    }

    pub fn policy(&self) -> Result<Policy, ExportError> {
        let Plan { maze, config } = &self.plan;
        let percepts = config.sensor.percepts(maze);
        Policy::new(
            &self.knowledge,
            self.width(),
            maze.action_count(),
            &percepts,
        )
    }

    fn text(&self, target: Target) -> String {
        let origin = Provenance::new(&self.plan, &self.knowledge, true);
        target.text(&self.policy().unwrap(), &origin)
    }

    /// All percepts of up to 16 bits; of wider ones those of the world and a million drawn, half
    /// of them so that some rule matches.
    fn percepts(&self) -> Vec<Percept> {
        let width = self.width();
        if width <= 16 {
            return (0..1 << width)
                .map(|word| Percept::from_word(word, width))
                .collect();
        }
        let mut percepts = self.plan.config.sensor.percepts(&self.plan.maze);
        let known = percepts.clone();
        let mut stream = Stream::new(77, 0_u64);
        percepts.extend((0..1_000_000).map(|at| {
            let like = known[stream.below(known.len())];
            let bits = (0..width).map(|bit| {
                let keeps = at % 2 == 0 && stream.below(8) > 0;
                if keeps {
                    like.bit(bit)
                } else {
                    stream.below(2) == 1
                }
            });
            Percept::from_bits(bits).unwrap()
        }));
        percepts
    }

    /// In how many percepts the bytes name no action that the learner rates best.
    fn differences(&self, percepts: &[Percept], chosen: &[u8]) -> usize {
        assert_eq!(chosen.len(), percepts.len(), "one answer for each percept");
        let actions = self.plan.maze.action_count();
        let differs = |&(percept, &chosen): &(&Percept, &u8)| {
            let values = self.knowledge.values(percept, actions);
            let mut best = values.best_actions().map(Action::index);
            match chosen {
                NONE => values.greatest().is_some(),
                chosen => !best.any(|best| best == usize::from(chosen)),
            }
        };
        percepts.iter().zip(chosen).filter(differs).count()
    }
}

/// The percepts as the exported functions read them.
fn bytes(percepts: &[Percept]) -> Vec<u8> {
    let of_one = |percept: &Percept| {
        let bytes: Vec<u8> = percept
            .words()
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect();
        bytes[..percept.width().div_ceil(8)].to_vec()
    };
    percepts.iter().flat_map(of_one).collect()
}

fn lines(percepts: &[Percept]) -> Vec<u8> {
    percepts
        .iter()
        .flat_map(|percept| format!("{percept}\n").into_bytes())
        .collect()
}

/// What a command prints when it is fed with this; it must end well and warn of nothing.
pub fn fed(command: &mut Command, input: Vec<u8>) -> Vec<u8> {
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command
        .spawn()
        .unwrap_or_else(|cause| panic!("{command:?}: {cause}"));
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().unwrap();
    let _ = writer.join().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && stderr.is_empty(),
        "{command:?}: {stderr}"
    );
    output.stdout
}

fn compiled_c(folder: &Path, header: &str) -> Command {
    fs::write(folder.join("policy.h"), header).unwrap();
    fs::write(folder.join("main.c"), C_MAIN).unwrap();
    compile_c(folder);
    Command::new(folder.join("decide"))
}

/// Compiles `main.c` as `decide`.
pub fn compile_c(folder: &Path) {
    let mut compiler = Command::new("cc");
    let strict = "-std=c99 -O1 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Werror";
    let files = ["main.c", "-o", "decide"];
    compiler.args(strict.split(' ')).args(files);
    fed(compiler.current_dir(folder), Vec::new());
}

fn compiled_rust(folder: &Path, module: &str) -> Command {
    fs::write(folder.join("policy.rs"), module).unwrap();
    fs::write(folder.join("main.rs"), RUST_MAIN).unwrap();
    compile_rust(folder);
    Command::new(folder.join("decide"))
}

/// Compiles `policy.rs` without the standard library, and `main.rs` with it as `decide`.
pub fn compile_rust(folder: &Path) {
    let rustc = || {
        let mut command = Command::new(std::env::var("RUSTC").unwrap_or("rustc".to_owned()));
        command
            .args(["--edition", "2024", "-D", "warnings"])
            .current_dir(folder);
        command
    };
    fs::write(folder.join("bare.rs"), "#![no_std]\npub mod policy;\n").unwrap();
    fed(rustc().args(["--crate-type", "lib", "bare.rs"]), Vec::new());
    // The names of the actions are for users that print them.
    fed(
        rustc().args(["-A", "dead_code", "main.rs", "-o", "decide"]),
        Vec::new(),
    );
}

pub fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn the_c99_header_compiles_without_warnings_and_chooses_as_the_learner_in_every_percept() {
    for (method, sensor) in [
        (Method::XcscrPlus, Sensor::Neighbours),
        (Method::Xcscr, Sensor::Neighbours),
        (Method::QLearning, Sensor::Neighbours),
        (Method::XcscrPlus, Sensor::NeighboursPosition),
    ] {
        let learned = Learned::new("maze6", method, sensor);
        let (percepts, folder) = (learned.percepts(), folder());
        let mut program = compiled_c(folder.path(), &learned.text(Target::C99));
        let chosen = fed(&mut program, bytes(&percepts));
        let differences = learned.differences(&percepts, &chosen);
        assert_eq!(
            differences,
            0,
            "{method:?} {sensor:?}, {} percepts",
            percepts.len()
        );
    }
}

#[test]
fn the_rust_module_needs_no_standard_library_and_chooses_as_the_learner() {
    let learned = Learned::new("maze5", Method::XcscrPlus, Sensor::Neighbours);
    let (percepts, folder) = (learned.percepts(), folder());
    let mut program = compiled_rust(folder.path(), &learned.text(Target::Rust));
    let chosen = fed(&mut program, bytes(&percepts));
    assert_eq!(learned.differences(&percepts, &chosen), 0);
}

#[test]
fn the_python_module_chooses_as_the_learner() {
    let learned = Learned::new("maze4", Method::XcscrPlus, Sensor::Neighbours);
    let (percepts, folder) = (learned.percepts(), folder());
    fs::write(
        folder.path().join("policy.py"),
        learned.text(Target::Python),
    )
    .unwrap();
    fs::write(folder.path().join("main.py"), PYTHON_MAIN).unwrap();
    let mut python = Command::new("python3");
    let chosen = fed(
        python.arg("main.py").current_dir(folder.path()),
        lines(&percepts),
    );
    assert_eq!(learned.differences(&percepts, &chosen), 0);
}

/// A header whose last rule has another action.
pub fn with_another_action(header: &str) -> String {
    let table = header.find("xcscr_rules[XCSCR_RULES]").unwrap();
    let end = table + header[table..].find("\n};").unwrap();
    let fields: Vec<&str> = header[..end].rsplitn(4, ", ").collect();
    let [value, weight, action, before] = fields[..] else {
        panic!("no rule: {header}");
    };
    let other = if action == "0" { "1" } else { "0" };
    let after = &header[end..];
    format!("{before}, {other}, {weight}, {value}{after}")
}

#[test]
fn control_one_rule_with_another_action_is_found() {
    let learned = Learned::new("maze6", Method::XcscrPlus, Sensor::Neighbours);
    let header = learned.text(Target::C99);
    let forged = with_another_action(&header);
    let (percepts, folder) = (learned.percepts(), folder());
    let chosen = fed(&mut compiled_c(folder.path(), &forged), bytes(&percepts));
    assert!(learned.differences(&percepts, &chosen) > 0);
}

#[test]
fn a_ballot_decides_as_the_learner_on_the_host_too() {
    let learned = Learned::new("maze5", Method::AdaptedEven, Sensor::Neighbours);
    let (policy, percepts) = (learned.policy().unwrap(), learned.percepts());
    let decide = |percept| {
        policy
            .quantised()
            .decide(percept)
            .map_or(NONE, |action| action.index() as u8)
    };
    let chosen: Vec<u8> = percepts.iter().map(decide).collect();
    assert_eq!(learned.differences(&percepts, &chosen), 0);
}

#[test]
fn export_writes_a_file_once_says_where_it_comes_from_and_prints_data() {
    let folder = folder();
    let run = folder.path().join("run").display().to_string();
    let file = folder.path().join("policy.h").display().to_string();
    let train = [
        "train",
        "worlds/maze4.json",
        "--arena",
        "grid",
        "--record",
        "none",
    ];
    let rest = [
        "--method",
        "xcscr-plus",
        "--seed",
        "9",
        "--episodes",
        "60",
        "--quiet",
        "--out",
        &run,
    ];
    ended(
        &xcscr(&[&train[..], &rest].concat()).output().unwrap(),
        0,
        "train",
    );
    let export = |target: &str, more: &[&str]| {
        let first = ["export", run.as_str(), "--target", target];
        xcscr(&[&first[..], more].concat()).output().unwrap()
    };
    ended(&export("c99", &["-o", &file]), 0, "export");
    let text = fs::read_to_string(&file).unwrap();
    for fact in [
        "World maze4",
        "xcscr-plus with seed 9",
        "CRC-32 of the rules: ",
    ] {
        assert!(text.contains(fact), "{fact}: {text}");
    }
    ended(&export("rust", &["-o", &file]), 73, "a file that exists");
    assert_eq!(
        fs::read_to_string(&file).unwrap(),
        text,
        "nothing is overwritten"
    );
    ended(
        &export("rust", &["-o", &file, "--force"]),
        0,
        "a file that is replaced",
    );
    let (csv, _) = ended(&export("csv", &[]), 0, "csv");
    assert!(
        csv.starts_with("condition,action,weight,value,if,go\n"),
        "{csv}"
    );
    let (json, _) = ended(&export("json", &[]), 0, "json");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["origin"]["seed"], 9);
    assert_eq!(
        json["rules"].as_array().unwrap().len(),
        csv.lines().count() - 1
    );
    let (dot, _) = ended(&export("dot", &[]), 0, "dot");
    assert_eq!(
        dot.matches(" -> action").count(),
        csv.lines().count() - 1,
        "{dot}"
    );
}
