//! Many robots in one batch drive as each would alone, to the bit.

use std::path::Path;

use xcscr::arena::{Arena, BatchArena, Outcome, PhysicsArena, PhysicsParams, Sample, View};
use xcscr::streams::StreamName;
use xcscr::world::Maze;
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

const SEEDS: [u64; 8] = [1, 2, 3, 4, 5, 6, 7, 8];
const MOVES: usize = 250;

fn maze() -> Maze {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/maze4.json");
    Maze::load(&file).unwrap()
}

fn batch(params: &PhysicsParams) -> BatchArena {
    BatchArena::new(&maze(), params, &SEEDS).unwrap()
}

fn alone(params: &PhysicsParams, seed: u64) -> PhysicsArena {
    PhysicsArena::new(maze(), params.clone(), seed).unwrap()
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

/// Robots that are in a hurry, often against a wall when their time is up, or not.
fn ways() -> impl Iterator<Item = PhysicsParams> {
    let times = [0.5, 10.0].into_iter();
    times.flat_map(|time_out_s| {
        [false, true].map(|shortcut| PhysicsParams {
            noise: 2.0,
            shortcut,
            time_out_s,
            ..PhysicsParams::default()
        })
    })
}

/// Lane by lane after some move: is it in column `lanes` what the lone robot shows?
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
    let mut hits = 0;
    for params in ways() {
        let mut batch = batch(&params);
        let mut alone = SEEDS.map(|seed| alone(&params, seed));
        let starts = maze().start_cells();
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
    }
    assert!(hits > 1000, "the robots hit walls only {hits} times");
}

/// The control: bits do differ where robots do.
#[test]
fn lanes_of_different_seeds_do_not_drive_alike() {
    let mut batch = batch(&PhysicsParams::default());
    batch.act(&SEEDS.map(|_| Action::new(1).unwrap()));
    let trace = |lane| bits(batch.view(lane).unwrap().trace);
    assert_ne!(trace(0), trace(1));
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
    batch.reset(SEEDS.len(), maze().goals()[0]);
    assert!(batch.view(SEEDS.len()).is_none());
    assert_eq!((batch.len(), batch.is_empty()), (8, false));
}
