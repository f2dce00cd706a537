//! Many robots in one batch drive as each would alone, to the bit.

use xcscr::arena::{Arena, BatchArena, Outcome, PhysicsArena, PhysicsParams, Sample, View};
use xcscr::streams::StreamName;
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

use crate::kit::trial::maze;

const SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];
const MOVES: usize = 250;

fn batch(params: &PhysicsParams) -> BatchArena {
    BatchArena::new(&maze("maze4"), params, &SEEDS).unwrap()
}

/// Every number of a path, as bits.
fn bits(trace: &[Sample]) -> Vec<[u64; 7]> {
    let sample = |s: &Sample| {
        let (at, turn) = (s.robot_in_map.translation, s.robot_in_map.rotation);
        let [left, right] = s.wheel_travel_m;
        let [x, y, re, im, left, right] =
            [at.x, at.y, turn.re, turn.im, left, right].map(f64::to_bits);
        [s.time_ns, x, y, re, im, left, right]
    };
    trace.iter().map(sample).collect()
}

/// Is it in column `lanes` what the lone robot shows?
fn assert_lane_is_like(batch: &BatchArena, lane: usize, view: &View<'_>, outcome: Outcome) {
    let (lanes, now) = (batch.lanes(), view.now());
    let pose = now.robot_in_map;
    assert_eq!(lanes.cells[lane], view.cell);
    assert_eq!(lanes.x_m[lane].to_bits(), pose.translation.x.to_bits());
    assert_eq!(lanes.y_m[lane].to_bits(), pose.translation.y.to_bits());
    assert_eq!(lanes.headings[lane], [pose.rotation.re, pose.rotation.im]);
    assert_eq!(lanes.times_ns[lane], now.time_ns);
    assert_eq!(lanes.outcomes[lane], Some(outcome));
    let seen = batch.view(lane).unwrap();
    assert_eq!(bits(seen.trace), bits(view.trace));
    assert_eq!(seen.contacts, view.contacts);
}

#[test]
fn every_lane_has_the_bits_of_a_lone_robot_with_resets_at_different_times() {
    let (mut hits, starts) = (0, maze("maze4").start_cells());
    // Robots that are in a hurry, often against a wall when their time is up, and others.
    for (time_out_s, shortcut) in [(0.5, false), (0.5, true), (10.0, false), (10.0, true)] {
        let params = PhysicsParams {
            noise: 2.0,
            shortcut,
            time_out_s,
            ..PhysicsParams::default()
        };
        let mut batch = batch(&params);
        let alone = |seed| PhysicsArena::new(maze("maze4"), params.clone(), seed).unwrap();
        let mut alone = SEEDS.map(alone);
        let mut stream = Stream::new(1, StreamName::Exploration);
        for number in 0..MOVES {
            let actions = SEEDS.map(|_| Action::new(stream.below(4)).unwrap());
            batch.act(&actions);
            for (lane, arena) in alone.iter_mut().enumerate() {
                let outcome = arena.act(actions[lane]);
                hits += arena.view().contacts.len();
                assert_lane_is_like(&batch, lane, &arena.view(), outcome);
                // Each lane has its own time between two resets, and its own starts.
                if number % (7 + 3 * lane) == 0 {
                    let start = starts[(number + lane) % starts.len()];
                    arena.reset(start);
                    batch.reset(lane, start);
                    assert_eq!(batch.lanes().outcomes[lane], None);
                }
            }
        }
        let trace = |lane| bits(batch.view(lane).unwrap().trace);
        assert_ne!(trace(0), trace(1), "control: robots differ");
    }
    assert!(hits > 1000, "the robots hit walls only {hits} times");
}

#[test]
fn a_lane_without_an_action_stays_as_it_is_and_one_that_does_not_exist_is_ignored() {
    let mut batch = batch(&PhysicsParams::default());
    let before = batch.lanes().clone();
    batch.act(&[Action::new(1).unwrap(); 3]);
    let after = batch.lanes();
    assert_eq!(before.times_ns[3..], after.times_ns[3..]);
    assert_eq!(before.x_m[3..], after.x_m[3..]);
    assert!(after.times_ns[..3].iter().all(|&time| time > 0));
    batch.reset(SEEDS.len(), maze("maze4").goals()[0]);
    assert!(batch.view(SEEDS.len()).is_none());
    assert_eq!((batch.len(), batch.is_empty()), (8, false));
}
