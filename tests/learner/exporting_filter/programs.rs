//! Exported policies with a filter as programs that are told what is perceived, and answer.

use std::fs;
use std::path::Path;
use std::process::Command;

use xcscr::export::Target;

use crate::exporting::{compile_c, compile_rust};

/// Commands of eleven bytes: `r` resets; `p`, bumped, one that means nothing here, eight bytes of percept
/// asks for an action and the likeliest place; `a` and an action says that something else is done.
const C_MAIN: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    static struct xcscr_filter filter;
    uint8_t line[11];
    while (fread(line, 1, sizeof line, stdin) == sizeof line) {
        if (line[0] == 'r') {
            xcscr_reset(&filter);
        } else if (line[0] == 'a') {
            filter.action = (int8_t)line[1];
        } else {
            const int8_t action = xcscr_perceive(&filter, line + 3, line[1]);
            uint16_t likeliest = xcscr_likeliest(&filter);
            likeliest = likeliest == XCSCR_PLACES ? 65535 : likeliest;
            putchar((uint8_t)action);
            putchar((uint8_t)(likeliest & 255));
            putchar((uint8_t)(likeliest >> 8));
            fflush(stdout);
        }
    }
    return 0;
}
"#;

const RUST_MAIN: &str = r#"
use std::io::{Read, Write};
mod policy;

pub fn main() {
    let mut filter = policy::Filter::new();
    let mut line = [0; 11];
    while std::io::stdin().read_exact(&mut line).is_ok() {
        match line {
            [b'r', ..] => filter = policy::Filter::new(),
            [b'a', action, ..] => filter.action = Some(action),
            [_, bumped, ..] => {
                let percept = line[3..3 + policy::PERCEPT_BYTES].try_into().unwrap();
                let action = filter.perceive(percept, bumped > 0);
                let likeliest = filter.likeliest();
                let likeliest = if likeliest == policy::PLACES { u16::MAX } else { likeliest as u16 };
                let [low, high] = likeliest.to_le_bytes();
                let mut stdout = std::io::stdout();
                stdout.write_all(&[action.unwrap_or(255), low, high]).unwrap();
                stdout.flush().unwrap();
            }
        }
    }
}
"#;

const PYTHON_MAIN: &str = r#"
import sys
import policy
filter = policy.Filter()
while line := sys.stdin.buffer.read(11):
    if line[0] == ord("r"):
        filter = policy.Filter()
    elif line[0] == ord("a"):
        filter.action = line[1]
    else:
        word = int.from_bytes(line[3:], "little")
        percept = "".join(str(word >> bit & 1) for bit in range(len(policy.BITS)))
        action = filter.perceive(percept, line[1])
        likeliest = filter.likeliest()
        action = 255 if action is None else action
        likeliest = 65535 if likeliest == policy.NEVER_MET else likeliest
        sys.stdout.buffer.write(bytes([action, likeliest & 255, likeliest >> 8]))
        sys.stdout.buffer.flush()
"#;

/// Prints the sizes of the tables and of a filter.
pub const C_SIZES: &str = r#"
#include "policy.h"
#include <stdio.h>

int main(void)
{
    static const uint8_t percept[XCSCR_PERCEPT_BYTES];
    struct xcscr_filter filter;
    xcscr_reset(&filter);
    (void)xcscr_perceive(&filter, percept, 0);
    printf("%d %d\n", (int)(sizeof xcscr_places + sizeof xcscr_lines + sizeof xcscr_looks), (int)sizeof filter);
    return 0;
}
"#;

pub const RUST_SIZES: &str = r#"
mod policy;

pub fn main() {
    let constants = size_of_val(&policy::KNOWN) + size_of_val(&policy::LINES) + size_of_val(&policy::LOOKS);
    println!("{constants} {}", size_of::<policy::Filter>());
}
"#;

/// A program made of a header.
pub fn compiled(folder: &Path, header: &str) -> Command {
    fs::write(folder.join("policy.h"), header).unwrap();
    fs::write(folder.join("main.c"), C_MAIN).unwrap();
    compile_c(folder);
    Command::new(folder.join("decide"))
}

fn compiled_rust(folder: &Path, module: &str) -> Command {
    fs::write(folder.join("policy.rs"), module).unwrap();
    fs::write(folder.join("main.rs"), RUST_MAIN).unwrap();
    compile_rust(folder);
    Command::new(folder.join("decide"))
}

fn interpreted(folder: &Path, module: &str) -> Command {
    fs::write(folder.join("policy.py"), module).unwrap();
    fs::write(folder.join("main.py"), PYTHON_MAIN).unwrap();
    let mut python = Command::new("python3");
    python.arg("main.py").current_dir(folder);
    python
}

/// What makes a program of an exported policy.
type Maker = fn(&Path, &str) -> Command;

pub const LANGUAGES: [(Target, Maker); 3] = [
    (Target::C99, compiled),
    (Target::Rust, compiled_rust),
    (Target::Python, interpreted),
];
