//! Exported policies as programs that are told what is perceived, and answer.

use std::fs;
use std::path::Path;
use std::process::Command;

use xcscr::export::Target;

use crate::exporting::{compile_c, compile_rust};

/// Commands of eleven bytes: `r` resets; `p`, bumped, rewarded, eight bytes of percept asks for an action
/// and the likeliest state; `a` and an action says that something else is done.
pub const C_MAIN: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    static struct xcscr_tracker tracker;
    uint8_t line[11];
    while (fread(line, 1, sizeof line, stdin) == sizeof line) {
        if (line[0] == 'r') {
            xcscr_reset(&tracker);
        } else if (line[0] == 'a') {
            tracker.action = (int8_t)line[1];
        } else {
            const uint16_t percept = (uint16_t)(line[3] | line[4] << 8);
            const int8_t action = xcscr_perceive(&tracker, percept, line[1], line[2]);
            const uint16_t likeliest = xcscr_likeliest(&tracker);
            putchar((uint8_t)action);
            putchar((uint8_t)(likeliest & 255));
            putchar((uint8_t)(likeliest >> 8));
            fflush(stdout);
        }
    }
    return 0;
}
"#;

pub const RUST_MAIN: &str = r#"
use std::io::{Read, Write};
mod policy;

pub fn main() {
    let mut tracker = policy::Tracker::new();
    let mut line = [0; 11];
    while std::io::stdin().read_exact(&mut line).is_ok() {
        match line {
            [b'r', ..] => tracker = policy::Tracker::new(),
            [b'a', action, ..] => tracker.action = Some(action),
            [_, bumped, rewarded, low, high, ..] => {
                let percept = u16::from_le_bytes([low, high]);
                let action = tracker.perceive(percept, bumped > 0, rewarded > 0);
                let [low, high] = tracker.likeliest().unwrap_or(policy::GOAL).to_le_bytes();
                let mut stdout = std::io::stdout();
                stdout.write_all(&[action.unwrap_or(255), low, high]).unwrap();
                stdout.flush().unwrap();
            }
        }
    }
}
"#;

pub const PYTHON_MAIN: &str = r#"
import sys
import policy
tracker = policy.Tracker()
while line := sys.stdin.buffer.read(11):
    if line[0] == ord("r"):
        tracker = policy.Tracker()
    elif line[0] == ord("a"):
        tracker.action = line[1]
    else:
        action = tracker.perceive(line[3] | line[4] << 8, line[1], line[2])
        likeliest = tracker.likeliest()
        action = 255 if action is None else action
        likeliest = 65535 if likeliest is None else likeliest
        sys.stdout.buffer.write(bytes([action, likeliest & 255, likeliest >> 8]))
        sys.stdout.buffer.flush()
"#;

/// Prints the sizes of the table of states and of a tracker.
pub const C_SIZES: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    struct xcscr_tracker tracker;
    xcscr_reset(&tracker);
    (void)xcscr_perceive(&tracker, 0, 0, 0);
    printf("%d %d\n", (int)sizeof xcscr_states, (int)sizeof tracker);
    return 0;
}
"#;

pub const RUST_SIZES: &str = r#"
mod policy;

pub fn main() {
    let tracker = policy::Tracker::new();
    println!("{} {}", size_of_val(&policy::STATE_TABLE), size_of_val(&tracker));
}
"#;

/// A program made of a header.
pub fn compiled(folder: &Path, header: &str) -> Command {
    fs::write(folder.join("policy.h"), header).unwrap();
    fs::write(folder.join("main.c"), C_MAIN).unwrap();
    compile_c(folder);
    Command::new(folder.join("decide"))
}

pub fn compiled_rust(folder: &Path, module: &str) -> Command {
    fs::write(folder.join("policy.rs"), module).unwrap();
    fs::write(folder.join("main.rs"), RUST_MAIN).unwrap();
    compile_rust(folder);
    Command::new(folder.join("decide"))
}

pub fn interpreted(folder: &Path, module: &str) -> Command {
    fs::write(folder.join("policy.py"), module).unwrap();
    fs::write(folder.join("main.py"), PYTHON_MAIN).unwrap();
    let mut python = Command::new("python3");
    python.arg("main.py").current_dir(folder);
    python
}

/// What makes a program of an exported policy.
pub type Maker = fn(&Path, &str) -> Command;

pub const LANGUAGES: [(Target, Maker); 3] = [
    (Target::C99, compiled),
    (Target::Rust, compiled_rust),
    (Target::Python, interpreted),
];
