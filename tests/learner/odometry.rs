//! What a robot learns of how its actions displace it, if it does not know.

use xcscr::agent::{Agent, Estimator, Explorer, Frozen, Method, MotionPrior, Setup};
use xcscr::arena::{Arena, GridArena, Outcome, View};
use xcscr::episode;
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::Bounds;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

use crate::learned::{learned, mapped, with, world};

/// A grid on which other moves than usual belong to the actions, of which some slip.
struct Relabelled {
    grid: GridArena,
    labels: [usize; 8],
    slip: f64,
    stream: Stream,
}

impl Relabelled {
    fn new(maze: Maze, case: Case) -> Self {
        let mut stream = Stream::new(case.seed, StreamName::Slip);
        let mut labels = [0, 1, 2, 3, 4, 5, 6, 7];
        if case.shuffled {
            stream.shuffle(&mut labels);
        }
        Self {
            grid: GridArena::new(maze),
            labels,
            slip: case.slip,
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
        let executed = match slips {
            true => self.stream.below(8),
            false => action.index(),
        };
        self.grid.act(Action::new(self.labels[executed]).unwrap())
    }

    fn view(&self) -> View<'_> {
        self.grid.view()
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.grid.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.grid.reseed(seed);
    }
}

/// What a robot is told of its actions, and what is true of them.
#[derive(Clone, Copy)]
struct Case {
    motion_model: MotionPrior,
    shuffled: bool,
    slip: f64,
    seed: u64,
}

impl Case {
    /// An environment without slip, for a robot that learns what its actions do.
    fn learned(shuffled: bool, seed: u64) -> Self {
        Self {
            motion_model: MotionPrior::Learned,
            shuffled,
            slip: 0.0,
            seed,
        }
    }
}

/// How many times the steps of the belief bound the greedy policy takes after so many episodes.
fn ratio(name: &str, case: Case, episodes: u32) -> f64 {
    const LIMIT: u32 = 100;
    let maze = world(&format!("classic/{name}"));
    let mut setup = Setup::default();
    setup.map.motion_model = case.motion_model;
    setup.reward.step_threshold = LIMIT;
    setup.plus.estimator = Estimator::Map;
    let mut method = Method::XcscrPlus.build(8, 16, setup, case.seed);
    let mut arena = Relabelled::new(maze.clone(), case);
    let mut explorer = Explorer::new(0.0, Stream::new(case.seed, StreamName::Exploration));
    let (starts, sensor) = (maze.start_cells(), Sensor::Neighbours);
    let mut run = |number, start: Cell, agent: &mut dyn Agent| {
        let arena = &mut arena;
        let (episode, _) =
            episode::run(number, start, arena, sensor, agent, &mut explorer, &mut ());
        episode.steps
    };
    let mut chance = Stream::new(case.seed, StreamName::Start);
    for number in 1..=episodes {
        run(number, *chance.choose(&starts).unwrap(), method.as_mut());
    }
    let mut policy = Frozen::new(method.knowledge(), 8, LIMIT);
    let runs = if case.slip > 0.0 {
        500 / starts.len()
    } else {
        1
    };
    let drives = (0..runs).flat_map(|_| &starts);
    let steps: u32 = drives.map(|start| run(1, *start, &mut policy)).sum();
    let mean = f64::from(steps) / (runs * starts.len()) as f64;
    mean / Bounds::of_belief(&maze, sensor).unwrap()
}

#[test]
fn what_actions_do_is_learned_just_as_well_whatever_they_are_called() {
    let mut failed = Vec::new();
    for world in ["maze10", "mazef4", "woods101", "littman57"] {
        for (shuffled, seed) in [(false, 1), (true, 2), (true, 3), (true, 4)] {
            let ratio = ratio(world, Case::learned(shuffled, seed), 50);
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
        let [wrong, right] = [true, false].map(|shuffled| {
            let case = Case {
                motion_model: MotionPrior::Known,
                ..Case::learned(shuffled, seed)
            };
            ratio("maze10", case, 50)
        });
        let is_so = wrong > 3.0 && right <= 1.02;
        assert!(is_so, "seed {seed}: {wrong} and {right} times the bound");
    }
}

#[test]
fn what_actions_do_is_learned_where_they_slip_too() {
    let case = Case {
        slip: 0.25,
        ..Case::learned(true, 2)
    };
    // Who knows the maze takes 7.18 steps, by an estimate, and not the 5.06 without slips.
    let ratio = ratio("maze10", case, 200) * 5.06 / 7.18;
    assert!(ratio < 1.2, "{ratio} times the bound");
}

#[test]
fn who_neither_knows_its_moves_nor_feels_bumps_finds_the_shortest_way() {
    for seed in 1..=3 {
        let plan = mapped(world("maze4"), Method::XcscrPlus).episodes(30);
        let plan = with(plan.seed(seed), |settings| {
            settings.map.motion_model = MotionPrior::Learned;
            settings.map.feels_bumps = false;
        });
        let progress = &learned(plan).progress;
        assert!(progress.optimal, "seed {seed}: {progress:?}");
    }
}
