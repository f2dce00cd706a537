//! The Rust files that exports include, compiled, linted and tested as they are, with a small
//! policy in place of what a template writes.

/// Two cells in a row, west of the goal. The rule says to go east, which is action 0.
macro_rules! corridor {
    () => {
        const ACTIONS: usize = 2;
        const COLUMNS: u16 = 3;
        const ROWS: u16 = 1;
        const WRAPS: bool = false;
        const CELL_SIZE_M: f64 = 1.0;
        const ORIGIN_X_M: f64 = 10.0;
        const ORIGIN_Y_M: f64 = 0.0;
        const ORIGIN_COSINE: f64 = 1.0;
        const ORIGIN_SINE: f64 = 0.0;
        const RING_BITS: usize = 16;
        const COLUMN_BITS: usize = 0;
        const ROW_BITS: usize = 0;

        struct Rule {
            condition: Condition,
            action: u8,
            weight: u8,
            value: u16,
        }

        include!("templates/decide.rs");
        include!("templates/grid.rs");
    };
}

/// The maps of the corridor. The western cell is state 0.
macro_rules! maps {
    () => {
        const STATES: usize = 2;
        const GOAL: u16 = u16::MAX;
        const BEGIN: u16 = 0;
        const REWARDS: u8 = 4;

        static STATE_TABLE: [State; STATES] = [
            State {
                next: [1, 0],
                percept: 0x2222,
                x: -2,
                y: 0,
                map: 0,
                collected: 0,
            },
            State {
                next: [GOAL, 0],
                percept: 0x2232,
                x: -1,
                y: 0,
                map: 0,
                collected: 0,
            },
        ];

        static RULES: [Rule; 1] = [Rule {
            condition: Condition {
                percept: [0x2222, 0x2222],
                x: [i8::MIN, -1],
                y: [i8::MIN, i8::MAX],
                map: [0, 0],
                collected: [0, 0],
                last: [0, 0],
                before: [0, 0],
            },
            action: 0,
            weight: 255,
            value: 1,
        }];

        include!("templates/context.rs");
        include!("templates/tracker.rs");
    };
}

mod exact {
    const NEGLIGIBLE_ONE_IN: u32 = 10_000;

    corridor!();
    maps!();
    include!("templates/whole.rs");
    include!("templates/exact.rs");
    include!("templates/neighbours.rs");
}

mod noisy {
    const IGNORES_COLLISIONS: bool = false;
    const SLIP: f64 = 0.1;
    const OBSERVATION_ERROR: f64 = 0.01;
    const MISLOCALISED: f64 = 1e-3;
    const BEGUN_ELSEWHERE: f64 = 0.1;
    const NEGLIGIBLE: f64 = 1e-4;
    const SCAN_REACH: i32 = 3;
    const SCAN_NEAREST_M: f64 = 0.1;
    const SCAN_LOST_RANGE_M: f64 = 4.0;

    struct Ray {
        along: [i32; 2],
        across: [i32; 2],
        bits: usize,
        codes: &'static [u16],
    }

    static RAYS: [Ray; 1] = [Ray {
        along: [1, 0],
        across: [1, 0],
        bits: 1,
        codes: &[1, 0],
    }];

    corridor!();
    maps!();
    include!("templates/real.rs");
    include!("templates/noisy.rs");
    include!("templates/lidar.rs");
    include!("templates/scan.rs");
}

mod plain {
    const PERCEPT_BYTES: usize = 2;

    static RULES: [Rule; 1] = [Rule {
        condition: Condition([[0x22, 0x22], [0x00, 0x00]]),
        action: 0,
        weight: 255,
        value: 1,
    }];

    corridor!();
    include!("templates/percept.rs");
    include!("templates/masks.rs");
    include!("templates/neighbours.rs");
}

#[test]
fn trackers_follow_a_robot_along_a_corridor() {
    let mut tracker = exact::Tracker::new();
    assert_eq!(tracker.perceive(0x2222, false, false), Some(0));
    assert_eq!(tracker.perceive(0x2232, false, false), Some(0));
    assert_eq!(tracker.likeliest(), Some(1));
    let mut tracker = noisy::Tracker::new();
    assert_eq!(tracker.perceive(0x2222, false, false), Some(0));
    assert_eq!(tracker.perceive(0x2222, false, false), Some(0));
    assert_eq!(tracker.likeliest(), Some(1), "the percept has an error");
}

/// Checks the conversions of a module between poses, cells and percepts.
macro_rules! assert_grid {
    ($name:ident, $west:expr, $middle:expr) => {{
        use $name::{CellState, cell_from_pose, percept_from_map, pose_of_cell};

        assert_eq!(cell_from_pose(11.9, 0.1), Some((1, 0)));
        assert_eq!(cell_from_pose(9.9, 0.1), None);
        assert_eq!(cell_from_pose(f64::NAN, 0.1), None);
        assert_eq!(pose_of_cell(1, 0), (11.5, 0.5));
        let percept = |column| {
            percept_from_map(column, 0, |column, row| match (column, row) {
                (0 | 1, 0) => CellState::Free,
                (2, 0) => CellState::Goal,
                _ => CellState::Wall,
            })
        };
        assert_eq!([percept(0), percept(1)], [$west, $middle]);
    }};
}

#[test]
fn cells_and_percepts_follow_from_poses() {
    // Clockwise from north, two bits for a cell, the lowest first: free 00, wall 01, goal 11.
    assert_grid!(exact, 0xaa8a, 0x8aba);
    assert_grid!(plain, [0x8a, 0xaa], [0xba, 0x8a]);
    // One ray to the east, whose bit says that the next cell is occupied.
    assert_grid!(noisy, 0, 0);
}

#[test]
fn a_scan_shows_whether_the_next_cell_is_free() {
    let seen = |range_m| {
        let mut scan = noisy::Scan::begin(10.5, 0.5, 1.0, 0.0);
        (0..3).for_each(|_| scan.add(1.0, 0.0, Some(range_m)));
        scan.percept()
    };
    assert_eq!([seen(0.5), seen(2.5)], [1, 0]);
}

#[test]
fn rules_without_a_map_match_masked_percepts() {
    assert_eq!(plain::decide(&[0x22, 0x13]), Some(0));
    assert_eq!(plain::decide(&[0x20, 0x13]), None);
}
