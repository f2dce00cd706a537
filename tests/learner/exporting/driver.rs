//! Answers the questions of `driver.c`. Linked to a policy, with `--cfg scans` and `--cfg tracks`
//! where the policy has them.

use std::io::Write;

use bare::policy;

trait Shown {
    fn shown(&self) -> String;
}

impl<const N: usize> Shown for [u8; N] {
    fn shown(&self) -> String {
        let bits = |byte: &u8| {
            (0..8)
                .map(|at| char::from(b'0' + (byte >> at & 1)))
                .collect::<String>()
        };
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
    let look_up = |column: u16, row: u16| {
        match map[usize::from(row) * usize::from(policy::COLUMNS) + usize::from(column)] {
            b'#' => policy::CellState::Wall,
            b'G' => policy::CellState::Goal,
            _ => policy::CellState::Free,
        }
    };
    #[cfg(scans)]
    let mut scan = policy::Scan::begin(0.0, 0.0, 1.0, 0.0);
    #[cfg(tracks)]
    let mut tracker = policy::Tracker::new();
    let mut stdout = std::io::stdout().lock();
    for line in std::io::stdin().lines().map(Result::unwrap) {
        let (command, rest) = line.split_at(1);
        let n: Vec<u64> = rest
            .split_whitespace()
            .map(|n| u64::from_str_radix(n, 16).unwrap())
            .collect();
        let real: Vec<f64> = n.iter().map(|&n| f64::from_bits(n)).collect();
        let answer = match command {
            "c" => match policy::cell_from_pose(real[0], real[1]) {
                Some((column, row)) => format!("{column} {row}"),
                None => "outside".to_owned(),
            },
            "p" => {
                let (x, y) = policy::pose_of_cell(n[0] as u16, n[1] as u16);
                format!("{:016x} {:016x}", x.to_bits(), y.to_bits())
            }
            "m" => policy::percept_from_map(n[0] as u16, n[1] as u16, look_up).shown(),
            #[cfg(scans)]
            "b" => {
                scan = policy::Scan::begin(real[0], real[1], real[2], real[3]);
                continue;
            }
            #[cfg(scans)]
            "v" => {
                scan.move_to(real[0], real[1], real[2], real[3]);
                continue;
            }
            #[cfg(scans)]
            "a" => {
                let range = Some(real[2]).filter(|&range| range != f64::INFINITY);
                scan.add(real[0], real[1], range);
                continue;
            }
            #[cfg(scans)]
            "q" => scan.percept().shown(),
            #[cfg(tracks)]
            "r" => {
                tracker = policy::Tracker::new();
                continue;
            }
            #[cfg(tracks)]
            "t" => {
                let action = tracker.perceive(n[0] as u16, n[1] > 0, n[2] > 0);
                let likeliest = tracker.likeliest().unwrap_or(policy::GOAL);
                format!("{} {likeliest}", action.map_or(-1, i16::from))
            }
            #[cfg(tracks)]
            "o" => {
                tracker.action = Some(n[0] as u8);
                continue;
            }
            #[cfg(tracks)]
            "s" => {
                let constants = size_of_val(&policy::STATE_TABLE);
                format!("{constants} {}", size_of_val(&tracker))
            }
            #[cfg(not(tracks))]
            "d" => {
                let mut percept = [0; policy::PERCEPT_BYTES];
                percept.copy_from_slice(&n[0].to_le_bytes()[..policy::PERCEPT_BYTES]);
                policy::decide(&percept).map_or(-1, i16::from).to_string()
            }
            _ => panic!("{line}"),
        };
        writeln!(stdout, "{answer}").unwrap();
        stdout.flush().unwrap();
    }
}
