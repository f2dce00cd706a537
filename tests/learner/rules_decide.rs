//! The rules of `xcscr-plus` decide: its greedy policy comes from \[P\], and from nothing else.

use std::ops::ControlFlow;

use crate::kit::trial::on_the_grid;
use xcs::random::Stream;
use xcs::{Action, Condition, Percept, Population};
use xcscr::agent::{Agent, Chooser, Estimator, Explorer, Frozen, Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::episode::{Episode, Learned, Observer, Step};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::{Evaluation, Plan, Settings, Trial};
use xcscr::world::{MazeKind, Recipe};

/// What the rules decided: the percept, the action, and the condition of the rule that fired.
#[derive(Default)]
struct Decisions {
    made: Vec<(Percept, Action, Condition)>,
    unexplained: usize,
    most_rules: usize,
}

impl Observer for Decisions {
    fn stepped(&mut self, step: &Step<'_>) {
        match step.fired() {
            Some(fired) => self.made.push((step.percept, step.action, fired)),
            None => self.unexplained += usize::from(step.chooser == Chooser::Rules),
        }
    }

    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        self.most_rules = self.most_rules.max(episode.rules);
        ControlFlow::Continue(())
    }
}

fn trained(maze: &str, seed: u64, settings: &Settings) -> (Trial, Decisions) {
    let plan = on_the_grid(maze, Method::XcscrPlus).episodes(40);
    let plan = plan.seed(seed).settings(settings.clone());
    let mut trial = Trial::new(plan).unwrap();
    let mut decisions = Decisions::default();
    let _ = trial.run(&mut decisions);
    (trial, decisions)
}

fn rules(trial: &Trial) -> Population {
    trial.method().knowledge().rules().unwrap().clone()
}

fn best(rules: &Population, percept: &Percept) -> Vec<Action> {
    let frozen = Frozen::new(Knowledge::Rules(rules.clone()), 4, 1);
    frozen.values(percept).best_actions().collect()
}

#[test]
fn what_no_rule_covers_is_left_to_chance_and_counted_so() {
    let (trial, _) = trained("maze5", 1, &Settings::default());
    let plan = trial.plan();
    let percept = plan.config.sensor.percepts(&plan.maze)[0];
    let chooser = |rules: Population| {
        let mut frozen = Frozen::new(Knowledge::Rules(rules), 4, 1);
        let values = frozen.observe(&percept);
        let mut greedy = Explorer::new(0.0, Stream::new(1, StreamName::Exploration));
        frozen.choose(&values, &mut greedy).chooser
    };
    assert_eq!(chooser(rules(&trial)), Chooser::Rules, "control");
    assert_eq!(chooser(Population::default()), Chooser::Chance);
}

#[test]
fn each_step_that_rules_chose_names_a_rule_that_matches() {
    let (trial, decisions) = trained("maze5", 1, &Settings::default());
    assert_eq!(decisions.unexplained, 0);
    assert!(
        decisions.made.len() > 300,
        "{} decisions",
        decisions.made.len()
    );
    assert_eq!(trial.progress().chosen.rules, decisions.made.len() as u64);
    for (percept, _, fired) in decisions.made {
        assert!(fired.matches(&percept), "{fired} does not match {percept}");
    }
}

#[test]
fn the_rule_that_fired_is_the_cause_turned_to_another_action_it_turns_the_robot() {
    let (trial, decisions) = trained("maze4", 1, &Settings::default());
    let rules = rules(&trial);
    let mut turned = 0;
    for (percept, action, fired) in decisions.made.iter().rev().take(30) {
        let other = Action::new((action.index() + 1) % 4).unwrap();
        let advocates = rules
            .rules()
            .iter()
            .filter(|rule| rule.condition.matches(percept));
        if advocates.clone().count() != 1 {
            continue;
        }
        let swapped = rules.rules().iter().map(|rule| {
            let mut rule = *rule;
            if rule.condition == *fired && rule.action == *action {
                rule.action = other;
            }
            rule
        });
        let swapped = Population::try_from(swapped.collect::<Vec<_>>()).unwrap();
        assert_eq!(best(&rules, percept), [*action], "{percept}");
        assert_eq!(best(&swapped, percept), [other], "{percept}");
        turned += 1;
    }
    assert!(turned > 5, "{turned} decisions rest on one rule");
}

#[test]
fn few_rules_suffice_at_any_time() {
    let settings = Settings::default();
    for (maze, most) in [("maze4", 25), ("maze5", 25), ("maze6", 25)] {
        for seed in 1..=5 {
            let (trial, decisions) = trained(maze, seed, &settings);
            assert!(trial.progress().optimal, "{maze}, seed {seed}");
            assert!(
                decisions.most_rules <= most,
                "{maze}: {} rules",
                decisions.most_rules
            );
        }
    }
}

#[test]
fn an_optimum_that_was_found_in_maze4_is_not_lost_again_in_99_of_100_trials() {
    let settings = Settings::default();
    let never_lost = (1..=100).filter(|&seed| {
        let (trial, _) = trained("maze4", seed, &settings);
        trial.progress().optimal_share_after_first() == Some(1.0)
    });
    let kept = never_lost.count();
    assert!(kept >= 99, "{kept} of 100");
}

/// Does the greedy policy of the fittest `number` rules take a shortest path?
fn suffice(trial: &Trial, number: usize) -> bool {
    let mut rules = rules(trial).rules().to_vec();
    rules.sort_by(|a, b| b.fitness.total_cmp(&a.fitness));
    rules.truncate(number);
    let rules = Knowledge::Rules(Population::try_from(rules).unwrap());
    let found = Evaluation::run(trial.plan(), &rules, 10).unwrap();
    found.is_optimal()
}

#[test]
fn control_cut_down_to_its_eight_fittest_rules_it_mostly_finds_no_shortest_path() {
    for (maze, most) in [("maze4", 9), ("maze5", 1), ("maze6", 9)] {
        let mut on_percepts = Settings::default();
        on_percepts.plus.estimator = Estimator::Percept;
        let trials: Vec<_> = (1..=20)
            .map(|seed| trained(maze, seed, &on_percepts).0)
            .collect();
        let whole = trials.iter().filter(|trial| suffice(trial, 100)).count();
        let cut = trials.iter().filter(|trial| suffice(trial, 8)).count();
        assert_eq!(whole, 20, "{maze}: with all rules");
        assert!(cut <= most, "{maze}: {cut} with eight rules");
    }
}

/// Does a trial of so many rules at most find a shortest path through 40 x 40 cells?
fn finds_a_way_through(kind: MazeKind, most: usize) -> bool {
    let recipe = Recipe {
        kind,
        size: 40,
        seed: 1,
    };
    let mut settings = Settings::default();
    settings.xcs.population_size = most as u32;
    let plan = Plan::new(recipe.maze().unwrap())
        .method(Method::XcscrPlus)
        .arena(ArenaKind::Grid)
        .sensor(Sensor::NeighboursPosition)
        .episodes(30)
        .settings(settings);
    let mut trial = Trial::new(plan).unwrap();
    let _ = trial.run(&mut ());
    trial.progress().optimal
}

#[test]
fn control_in_40_x_40_cells_a_hundred_rules_do_not_suffice() {
    for kind in [MazeKind::Rooms, MazeKind::Random] {
        assert!(finds_a_way_through(kind, 400), "{}", kind.name());
        assert!(!finds_a_way_through(kind, 100), "{}", kind.name());
    }
}
