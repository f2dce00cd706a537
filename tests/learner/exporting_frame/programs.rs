//! Exported policies as programs that answer questions about cells, poses and percepts.

use std::fs;
use std::path::Path;
use std::process::Command;

use xcscr::export::Target;
use xcscr::world::{Cell, Maze};

use crate::exporting::{compile_c, compile_rust, fed, folder};

/// Lines of input: `c x y` asks for the cell of a point, `p column row` for the middle of a cell, `m column
/// row` for the percept there; `b` begins a scan at a pose (x, y, cosine, sine), `v` moves the robot there,
/// `a cosine sine range` adds a beam (infinite if nothing came back), `q` asks for the percept. Numbers are hexadecimal
/// bits of doubles where they are no cells. The argument is the map, row by row.
const C_MAIN: &str = r#"
#include "policy.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static uint8_t look_up(void *user, uint16_t column, uint16_t row)
{
    const char letter = ((const char *)user)[row * XCSCR_COLUMNS + column];
    return letter == '#' ? XCSCR_CELL_WALL : letter == 'G' ? XCSCR_CELL_GOAL : XCSCR_CELL_FREE;
}

static void show(const xcscr_word *percept)
{
    int bit;
    for (bit = 0; bit < XCSCR_WORDS * XCSCR_WORD_BITS; bit++) {
        putchar('0' + (percept[bit / XCSCR_WORD_BITS] >> (bit % XCSCR_WORD_BITS) & 1));
    }
    putchar('\n');
}

static double real(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

int main(int count, char **arguments)
{
    static xcscr_word percept[XCSCR_WORDS];
    char command;
    uint64_t n[4];
    uint16_t column;
    uint16_t row;
    double x;
    double y;
#if defined(XCSCR_SCAN_REACH)
    static struct xcscr_scan scan;
#endif
    if (count != 2) {
        return 1;
    }
    while (scanf(" %c %" SCNx64 " %" SCNx64 " %" SCNx64 " %" SCNx64, &command, n, n + 1, n + 2, n + 3) == 5) {
        switch (command) {
        case 'c':
            if (xcscr_cell_from_pose(real(n[0]), real(n[1]), &column, &row)) {
                printf("%u %u\n", (unsigned)column, (unsigned)row);
            } else {
                puts("outside");
            }
            break;
        case 'p':
            xcscr_pose_of_cell((uint16_t)n[0], (uint16_t)n[1], &x, &y);
            printf("%016" PRIx64 " %016" PRIx64 "\n", bits(x), bits(y));
            break;
        case 'm':
            xcscr_percept_from_map((uint16_t)n[0], (uint16_t)n[1], look_up, arguments[1], percept);
            show(percept);
            break;
#if defined(XCSCR_SCAN_REACH)
        case 'b':
            xcscr_scan_begin(&scan, real(n[0]), real(n[1]), real(n[2]), real(n[3]));
            break;
        case 'v':
            xcscr_scan_move(&scan, real(n[0]), real(n[1]), real(n[2]), real(n[3]));
            break;
        case 'a':
            xcscr_scan_add(&scan, real(n[0]), real(n[1]), real(n[2]));
            break;
        case 'q':
            xcscr_scan_percept(&scan, percept);
            show(percept);
            break;
#endif
        default:
            return 1;
        }
    }
    return 0;
}
"#;

const RUST_MAIN: &str = r#"
use std::io::Read;
mod policy;

trait Shown {
    fn shown(&self) -> String;
}

impl<const N: usize> Shown for [u8; N] {
    fn shown(&self) -> String {
        let bits = |byte: &u8| (0..8).map(|at| char::from(b'0' + (byte >> at & 1))).collect::<String>();
        self.iter().map(bits).collect()
    }
}

impl Shown for u16 {
    fn shown(&self) -> String {
        self.to_le_bytes().shown()
    }
}

fn main() {
    let map = std::env::args().nth(1).unwrap().into_bytes();
    let look_up = |column: u16, row: u16| match map[usize::from(row) * usize::from(policy::COLUMNS) + usize::from(column)] {
        b'#' => policy::CellState::Wall,
        b'G' => policy::CellState::Goal,
        _ => policy::CellState::Free,
    };
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).unwrap();
    {BEGIN}
    for line in text.lines() {
        let (command, rest) = line.split_at(1);
        let n: Vec<u64> = rest.split_whitespace().map(|n| u64::from_str_radix(n, 16).unwrap()).collect();
        let real: Vec<f64> = n.iter().map(|&n| f64::from_bits(n)).collect();
        match command {
            "c" => match policy::cell_from_pose(real[0], real[1]) {
                Some((column, row)) => println!("{column} {row}"),
                None => println!("outside"),
            },
            "p" => {
                let (x, y) = policy::pose_of_cell(n[0] as u16, n[1] as u16);
                println!("{:016x} {:016x}", x.to_bits(), y.to_bits());
            }
            "m" => println!("{}", policy::percept_from_map(n[0] as u16, n[1] as u16, look_up).shown()),
            {SCAN}
            _ => panic!("{line}"),
        }
    }
}
"#;

const RUST_BEGIN: &str = "let mut scan = policy::Scan::begin(0.0, 0.0, 1.0, 0.0);";

const RUST_SCAN: &str = r#"
            "b" => scan = policy::Scan::begin(real[0], real[1], real[2], real[3]),
            "v" => scan.move_to(real[0], real[1], real[2], real[3]),
            "a" => scan.add(real[0], real[1], Some(real[2]).filter(|&range| range != f64::INFINITY)),
            "q" => println!("{}", scan.percept().shown()),
"#;

const PYTHON_MAIN: &str = r##"
import struct
import sys
import policy

cells = sys.argv[1]
states = {"#": policy.WALL, "G": policy.GOAL}


def look_up(column, row):
    return states.get(cells[row * policy.COLUMNS + column], policy.FREE)


def show(percept):
    print("".join(str(percept >> at & 1) for at in range(16)) if isinstance(percept, int) else percept)


def real(number):
    return struct.unpack("<d", struct.pack("<Q", number))[0]


for line in sys.stdin:
    command, *numbers = line.split()
    n = [int(number, 16) for number in numbers]
    x, y, cosine, sine = map(real, n)
    if command == "c":
        cell = policy.cell_from_pose(x, y)
        print("outside" if cell is None else "{} {}".format(*cell))
    elif command == "p":
        middle = policy.pose_of_cell(n[0], n[1])
        print(*("{:016x}".format(*struct.unpack("<Q", struct.pack("<d", at))) for at in middle))
    elif command == "m":
        show(policy.percept_from_map(n[0], n[1], look_up))
    elif command == "b":
        scan = policy.Scan(x, y, cosine, sine)
    elif command == "v":
        scan.move(x, y, cosine, sine)
    elif command == "a":
        scan.add(x, y, cosine)
    else:
        show(scan.percept())
"##;

pub const LANGUAGES: [Target; 3] = [Target::C99, Target::Rust, Target::Python];

/// Questions to an exported program.
#[derive(Default)]
pub struct Questions(String);

impl Questions {
    fn ask(&mut self, command: char, numbers: [u64; 4]) {
        let [a, b, c, d] = numbers;
        self.0 += &format!("{command} {a:x} {b:x} {c:x} {d:x}\n");
    }

    fn say(&mut self, command: char, numbers: [f64; 4]) {
        self.ask(command, numbers.map(f64::to_bits));
    }

    /// In which cell is a point of the map frame?
    pub fn cell(&mut self, [x_m, y_m]: [f64; 2]) {
        self.say('c', [x_m, y_m, 0.0, 0.0]);
    }

    /// Where is the middle of a cell?
    pub fn middle(&mut self, cell: Cell) {
        self.ask('p', [cell.col.into(), cell.row.into(), 0, 0]);
    }

    /// What is perceived in a cell?
    pub fn percept(&mut self, cell: Cell) {
        self.ask('m', [cell.col.into(), cell.row.into(), 0, 0]);
    }

    /// A scan begins at a pose: x, y, cosine and sine.
    pub fn begin(&mut self, pose: [f64; 4]) {
        self.say('b', pose);
    }

    /// The robot has moved.
    pub fn moved(&mut self, pose: [f64; 4]) {
        self.say('v', pose);
    }

    /// A beam: cosine and sine of its bearing, and its range.
    pub fn beam(&mut self, [cosine, sine]: [f64; 2], range_m: Option<f64>) {
        self.say('a', [cosine, sine, range_m.unwrap_or(f64::INFINITY), 0.0]);
    }

    /// What is perceived after the scan?
    pub fn scanned(&mut self) {
        self.say('q', [0.0; 4]);
    }

    /// The answers of an exported policy in a language, one a line.
    pub fn answers(&self, target: Target, policy: &str, maze: &Maze) -> Vec<String> {
        let folder = folder();
        let mut program = program(folder.path(), target, policy);
        let letter = |cell| match (maze.is_wall(cell), maze.is_goal(cell)) {
            (true, _) => '#',
            (false, true) => 'G',
            (false, false) => '.',
        };
        let map: String = maze.cells().map(letter).collect();
        let printed = fed(
            program.arg(map).current_dir(folder.path()),
            self.0.clone().into_bytes(),
        );
        let text = String::from_utf8(printed).unwrap();
        text.lines().map(str::to_owned).collect()
    }
}

/// A program made of an exported policy.
fn program(folder: &Path, target: Target, policy: &str) -> Command {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    match target {
        Target::C99 => {
            write("policy.h", policy);
            write("main.c", C_MAIN);
            compile_c(folder);
        }
        Target::Rust => {
            let scans = policy.contains("pub struct Scan");
            let [begin, scan] = if scans {
                [RUST_BEGIN, RUST_SCAN]
            } else {
                ["", ""]
            };
            let main = RUST_MAIN.replace("{BEGIN}", begin).replace("{SCAN}", scan);
            write("policy.rs", policy);
            write("main.rs", &main);
            compile_rust(folder);
        }
        _ => {
            write("policy.py", policy);
            write("main.py", PYTHON_MAIN);
            let mut python = Command::new("python3");
            python.arg("main.py");
            return python;
        }
    }
    Command::new(folder.join("decide"))
}
