//! The rules of `xcscr-plus` decide: its greedy policy comes from \[P\], and from nothing else.

use std::ops::ControlFlow;

use xcs::random::Stream;
use xcs::{Action, Classifier, Condition, Params, Percept, Population};
use xcscr::agent::{Agent, DecisionSource, Estimator, Explorer, Frozen, Knowledge, Method};
use xcscr::episode::{Episode, Learned as Episodes, Observer, Step};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::{Compacted, Evaluation, Plan, Trial};
use xcscr::world::Paths;

use crate::learned::{Learned, gridded, learned, with, world};

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
            None => self.unexplained += usize::from(step.source == DecisionSource::Rules),
        }
    }

    fn ended(&mut self, episode: &Episode, _: &Episodes<'_>) -> ControlFlow<()> {
        self.most_rules = self.most_rules.max(episode.rules);
        ControlFlow::Continue(())
    }
}

fn plan(maze: &str, seed: u64) -> Plan {
    let plan = gridded(world(maze), Method::XcscrPlus);
    plan.episodes(40).seed(seed)
}

fn watched(maze: &str, seed: u64) -> (Trial, Decisions) {
    let mut trial = Trial::new(plan(maze, seed)).unwrap();
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
fn what_no_rule_covers_is_left_to_chance_and_each_step_of_rules_names_one_that_matches() {
    let (trial, decisions) = watched("maze5", 1);
    let plan = trial.plan();
    let percept = plan.config.sensor.percepts(&plan.maze)[0];
    let source = |rules: Population| {
        let mut frozen = Frozen::new(Knowledge::Rules(rules), 4, 1);
        let values = frozen.observe(&percept);
        let mut greedy = Explorer::new(0.0, Stream::new(1, StreamName::Exploration));
        frozen.choose(&values, &mut greedy).source
    };
    assert_eq!(source(rules(&trial)), DecisionSource::Rules, "control");
    assert_eq!(source(Population::default()), DecisionSource::Chance);
    let made = decisions.made.len();
    assert!(decisions.unexplained == 0 && made > 300, "{made} decisions");
    assert_eq!(trial.progress().chosen.rules, made as u64);
    for (percept, _, fired) in decisions.made {
        assert!(fired.matches(&percept), "{fired} does not match {percept}");
    }
}

#[test]
fn the_rule_that_fired_is_the_cause_turned_to_another_action_it_turns_the_robot() {
    let (trial, decisions) = watched("maze4", 1);
    let rules = rules(&trial);
    let mut turned = 0;
    for (percept, action, fired) in decisions.made.iter().rev().take(30) {
        let other = Action::new((action.index() + 1) % 4).unwrap();
        let all = rules.rules().iter();
        let advocates = all.filter(|rule| rule.condition.matches(percept));
        if advocates.count() != 1 {
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

/// How many alleles of rules are digits of a column or a row, and how many rules have ranges.
fn digits_and_ranges(trial: &Learned, rules: &Population) -> [usize; 2] {
    let Plan { maze, config } = &trial.plan;
    let width = config.sensor.width(maze);
    let first = width - config.sensor.place_bits(maze).iter().sum::<usize>();
    let conditions = || rules.rules().iter().map(|rule| rule.condition);
    let digits = conditions().flat_map(|one| (first..width).map(move |bit| one.allele(bit)));
    let ranges = conditions().filter(|one| one.ranges().next().is_some());
    [digits.flatten().count(), ranges.count()]
}

#[test]
fn conditions_over_a_place_are_ranges_also_compacted_and_in_a_file() {
    for sensor in [
        Sensor::Position,
        Sensor::NeighboursPosition,
        Sensor::LidarPosition,
    ] {
        for name in ["maze5", "random-12-1"] {
            let plan = |method| gridded(world(name), method).sensor(sensor).episodes(40);
            let trial = learned(plan(Method::XcscrPlus));
            let maze = &trial.plan.maze;
            let width = sensor.width(maze);
            let first = width - sensor.place_bits(maze).iter().sum::<usize>();
            let Knowledge::PerceptRules {
                rules,
                generalisation,
            } = &trial.knowledge
            else {
                panic!("{name}, {sensor:?}: another kind of rules");
            };
            let paths = Paths::new(maze);
            let compacted = Compacted::new(&trial.knowledge, sensor, maze, &paths).unwrap();
            assert!(compacted.optimal, "{name}, {sensor:?}");
            for rules in [rules, &compacted.rules] {
                let [digits, ranges] = digits_and_ranges(&trial, rules);
                assert!(
                    digits == 0 && ranges > 3,
                    "{name}, {sensor:?}: {digits} {ranges}"
                );
            }
            let mut collisions = generalisation.collisions.iter().map(|rule| rule.condition);
            let has_digit = |one: Condition| (first..width).any(|bit| one.allele(bit).is_some());
            assert!(!collisions.any(has_digit), "{name}, {sensor:?}");
            let text = serde_json::to_string(&trial.knowledge).unwrap();
            let read: Knowledge = serde_json::from_str(&text).unwrap();
            assert_eq!(read, trial.knowledge, "{name}, {sensor:?}");

            let genetic = learned(plan(Method::Xcs));
            let [digits, ranges] = digits_and_ranges(&genetic, genetic.knowledge.rules().unwrap());
            assert!(digits > 0 && ranges == 0, "control: {digits} {ranges}");
        }
    }
}

#[test]
fn a_range_of_other_bits_than_the_column_or_the_row_is_refused() {
    let trial = learned(
        gridded(world("maze5"), Method::XcscrPlus)
            .sensor(Sensor::Position)
            .episodes(40),
    );
    let Plan { maze, config } = &trial.plan;
    let refusal = |condition: &str| {
        let rule = Classifier::new(
            condition.parse().unwrap(),
            Action::new(0).unwrap(),
            0,
            &Params::default(),
        );
        let rules = Population::try_from(vec![rule]).unwrap();
        Knowledge::Rules(rules).check(config.sensor, maze).err()
    };
    assert_eq!(refusal("####[1-2:4]"), None, "control");
    let refused = refusal("###[1-2:4]#").unwrap().to_string();
    assert!(
        refused.contains("not of the column or the row"),
        "{refused}"
    );
}

#[test]
fn few_rules_suffice_at_any_time() {
    for maze in ["maze4", "maze5", "maze6"] {
        for seed in 1..=5 {
            let (trial, decisions) = watched(maze, seed);
            let most = decisions.most_rules;
            let is_so = trial.progress().optimal && most <= 25;
            assert!(is_so, "{maze}, seed {seed}: {most} rules");
        }
    }
}

#[test]
fn an_optimum_that_was_found_in_maze4_is_not_lost_again_in_99_of_100_trials() {
    let never_lost = (1..=100).filter(|&seed| {
        let progress = &learned(plan("maze4", seed)).progress;
        progress.optimal_share_after_first() == Some(1.0)
    });
    let kept = never_lost.count();
    assert!(kept >= 99, "{kept} of 100");
}

/// Does the greedy policy of the fittest `number` rules take a shortest path?
fn suffice(trial: &Learned, number: usize) -> bool {
    let mut rules = trial.knowledge.rules().unwrap().rules().to_vec();
    rules.sort_by(|a, b| b.fitness.total_cmp(&a.fitness));
    rules.truncate(number);
    let rules = Knowledge::Rules(Population::try_from(rules).unwrap());
    let found = Evaluation::run(&trial.plan, &rules, 10).unwrap();
    found.is_optimal()
}

#[test]
fn control_cut_down_to_its_eight_fittest_rules_it_mostly_finds_no_shortest_path() {
    for (maze, most) in [("maze4", 9), ("maze5", 1), ("maze6", 9)] {
        let trained = |seed| {
            learned(with(plan(maze, seed), |settings| {
                settings.plus.estimator = Estimator::Percept;
            }))
        };
        let trials: Vec<_> = (1..=20).map(trained).collect();
        let [whole, cut] = [100, 8].map(|number| {
            let sufficing = trials.iter().filter(|trial| suffice(trial, number));
            sufficing.count()
        });
        assert_eq!(whole, 20, "{maze}: with all rules");
        assert!(cut <= most, "{maze}: {cut} with eight rules");
    }
}

#[test]
fn control_in_40_x_40_cells_a_hundred_rules_do_not_suffice() {
    for maze in ["rooms-40-1", "random-40-1"] {
        let [enough, few] = [400, 100].map(|most| {
            let plan = gridded(world(maze), Method::XcscrPlus).episodes(30);
            let plan = with(plan.sensor(Sensor::NeighboursPosition), |settings| {
                settings.xcs.population_size = most;
            });
            learned(plan).progress.optimal
        });
        assert!(enough && !few, "{maze}: {enough} {few}");
    }
}
