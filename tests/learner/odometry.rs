//! What a robot learns of how its actions displace it, if it does not know.

use xcscr::agent::{Estimator, Explorer, Frozen, MapParams, Method, MotionPrior, Setup};
use xcscr::arena::{Arena, GridArena, Lasting, Outcome, View};
use xcscr::episode;
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::Bounds;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

use crate::kit::trial::{maze, on_a_map, on_the_grid};

/// A grid on which other moves than usual belong to the actions, of which some slip.
struct Relabelled {
    grid: GridArena,
    labels: [usize; 8],
    slip: f64,
    stream: Stream,
}

impl Relabelled {
    /// Labels in order, or shuffled.
    fn new(maze: Maze, shuffled: bool, slip: f64, seed: u64) -> Self {
        let mut stream = Stream::new(seed, StreamName::Slip);
        let mut labels = [0, 1, 2, 3, 4, 5, 6, 7];
        if shuffled {
            stream.shuffle(&mut labels);
        }
        let grid = GridArena::new(maze);
        Self {
            grid,
            labels,
            slip,
            stream,
        }
    }
}

impl Arena for Relabelled {
    fn reset(&mut self, start: Cell) {
        self.grid.reset(start);
    }

    fn act(&mut self, action: Action) -> Outcome {
        let slips = self.stream.chance(self.slip);
        let executed = if slips {
            self.stream.below(8)
        } else {
            action.index()
        };
        self.grid.act(Action::new(self.labels[executed]).unwrap())
    }

    fn view(&self) -> View<'_> {
        self.grid.view()
    }

    fn lasting(&self) -> Lasting {
        self.grid.lasting()
    }

    fn continue_from(&mut self, lasting: &Lasting) {
        self.grid.continue_from(lasting);
    }
}

/// What a robot is told of its actions.
#[derive(Clone, Copy)]
struct Told {
    motion_model: MotionPrior,
    shuffled: bool,
    slip: f64,
    seed: u64,
}

/// How many times the steps of the belief bound the greedy policy takes after so many episodes.
fn ratio(world: &str, told: Told, episodes: u32) -> f64 {
    const LIMIT: u32 = 100;
    let maze = maze(&format!("classic/{world}"));
    let Told {
        motion_model,
        shuffled,
        slip,
        seed,
    } = told;
    let mut setup = Setup {
        map: MapParams {
            motion_model,
            ..MapParams::default()
        },
        ..Setup::default()
    };
    setup.reward.step_threshold = LIMIT;
    setup.plus.estimator = Estimator::Map;
    let mut method = Method::XcscrPlus.build(8, 16, setup, seed);
    let mut arena = Relabelled::new(maze.clone(), shuffled, slip, seed);
    let mut explorer = Explorer::new(0.0, Stream::new(seed, StreamName::Exploration));
    let (starts, sensor) = (maze.start_cells(), Sensor::Neighbours);
    let mut chance = Stream::new(seed, StreamName::Start);
    for number in 1..=episodes {
        let start = *chance.choose(&starts).unwrap();
        let method = method.as_mut();
        let _ = episode::run(
            number,
            start,
            &mut arena,
            sensor,
            method,
            &mut explorer,
            &mut (),
        );
    }
    let mut policy = Frozen::new(method.knowledge(), 8, LIMIT);
    let runs = if slip > 0.0 { 500 / starts.len() } else { 1 };
    let mut steps = 0;
    for start in (0..runs).flat_map(|_| &starts) {
        let (episode, _) = episode::run(
            1,
            *start,
            &mut arena,
            sensor,
            &mut policy,
            &mut explorer,
            &mut (),
        );
        steps += episode.steps;
    }
    let mean = f64::from(steps) / (runs * starts.len()) as f64;
    mean / Bounds::of_belief(&maze, sensor).unwrap()
}

#[test]
fn what_actions_do_is_learned_just_as_well_whatever_they_are_called() {
    let mut failed = Vec::new();
    for world in ["maze10", "mazef4", "woods101", "littman57"] {
        for (shuffled, seed) in [(false, 1), (true, 2), (true, 3), (true, 4)] {
            let told = Told {
                motion_model: MotionPrior::Learned,
                shuffled,
                slip: 0.0,
                seed,
            };
            let ratio = ratio(world, told, 50);
            if ratio > 1.02 {
                failed.push(format!("{world}, seed {seed}: {ratio} times the bound"));
            }
        }
    }
    // In Maze10 some two of 24 trials fail.
    let excused = failed.len() <= 1 && failed.iter().all(|one| one.starts_with("maze10"));
    assert!(excused, "{failed:?}");
}

#[test]
fn control_who_is_told_the_wrong_directions_hardly_finds_the_goal() {
    for seed in [2, 3, 4] {
        let told = |shuffled| Told {
            motion_model: MotionPrior::Known,
            shuffled,
            slip: 0.0,
            seed,
        };
        let wrong = ratio("maze10", told(true), 50);
        assert!(wrong > 3.0, "seed {seed}: {wrong} times the bound");
        let right = ratio("maze10", told(false), 50);
        assert!(right <= 1.02, "seed {seed}: {right} times the bound");
    }
}

#[test]
fn what_actions_do_is_learned_where_they_slip_too() {
    let told = Told {
        motion_model: MotionPrior::Learned,
        shuffled: true,
        slip: 0.25,
        seed: 2,
    };
    // Who knows the maze takes 7.18 steps, by an estimate, and not the 5.06 without slips.
    let ratio = ratio("maze10", told, 200) * 5.06 / 7.18;
    assert!(ratio < 1.2, "{ratio} times the bound");
}

#[test]
fn who_neither_knows_its_moves_nor_feels_bumps_finds_the_shortest_way() {
    for seed in 1..=3 {
        let mut plan = on_a_map(on_the_grid("maze4", Method::XcscrPlus)).episodes(30);
        plan.config.settings.map.motion_model = MotionPrior::Learned;
        plan.config.settings.map.feels_bumps = false;
        let trial = plan.seed(seed).run().unwrap();
        let progress = trial.progress();
        assert!(progress.optimal, "seed {seed}: {progress:?}");
    }
}
