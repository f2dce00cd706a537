//! Exported policies are compiled or run as their users would, and do what the learner and the simulator do.

#[cfg(feature = "long")]
mod frame;
#[cfg(feature = "long")]
mod layers;
#[cfg(feature = "long")]
mod pixels;
mod program;

use xcscr::Error;
use xcscr::agent::{Knowledge, Method};
use xcscr::export::{Policy, Provenance, Target};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::xcs::random::Stream;
use xcscr::xcs::{Action, Percept};

use super::learned::{Learned, learned};
use crate::kit::chance::rounds;
use crate::kit::trial::on_the_grid;
use program::{Program, Questions};

/// A plan whose states are percepts.
fn deciding(world: &str, method: Method, sensor: Sensor) -> Plan {
    on_the_grid(world, method).sensor(sensor).episodes(60)
}

fn policy(learned: &Learned) -> Result<Policy, Error> {
    let Plan { maze, config } = &learned.plan;
    let (width, actions) = (config.sensor.width(maze), maze.action_count());
    let percepts = config.sensor.percepts(maze);
    Policy::new(&learned.knowledge, width, actions, &percepts)
}

fn text(learned: &Learned, target: Target) -> String {
    let origin = Provenance::new(&learned.plan, &learned.knowledge, true);
    target.text(&policy(learned).unwrap(), &origin)
}

/// All percepts of up to 16 bits; of wider ones those of the world and 200,000 drawn, half of them so that
/// some rule matches.
fn percepts(plan: &Plan) -> Vec<Percept> {
    let width = plan.config.sensor.width(&plan.maze);
    if width <= 16 {
        let words = 0..1 << width;
        return words.map(|word| Percept::from_word(word, width)).collect();
    }
    let known = plan.config.sensor.percepts(&plan.maze);
    let mut stream = Stream::new(77, 0_u64);
    let drawn = (0..200_000).map(|at| {
        let like = known[stream.below(known.len())];
        let bits = (0..width).map(|bit| match at % 2 == 0 && stream.below(8) > 0 {
            true => like.bit(bit),
            false => stream.below(2) == 1,
        });
        Percept::from_bits(bits).unwrap()
    });
    let drawn: Vec<Percept> = drawn.collect();
    [known, drawn].concat()
}

/// In how many percepts a number is none of the actions that the learner rates best.
fn differences(learned: &Learned, percepts: &[Percept], chosen: &[i16]) -> usize {
    assert_eq!(chosen.len(), percepts.len(), "one answer for each percept");
    let actions = learned.plan.maze.action_count();
    let differs = |&(percept, chosen): &(&Percept, &i16)| {
        let values = learned.knowledge.values(percept, actions);
        match usize::try_from(*chosen) {
            Ok(chosen) => !values.is_nearly_best(Action::new(chosen).unwrap()),
            Err(_) => values.greatest().is_some(),
        }
    };
    percepts.iter().zip(chosen).filter(differs).count()
}

/// What a program made of a source text chooses in these percepts.
fn chosen(target: Target, text: &str, percepts: &[Percept]) -> Vec<i16> {
    let mut questions = Questions::default();
    percepts
        .iter()
        .for_each(|one| questions.ask('d', &one.words()[..1]));
    let answers = Program::new(target, text).answers(&questions);
    answers.iter().map(|one| one.parse().unwrap()).collect()
}

/// A header whose last rule has another action.
fn with_another_action(header: &str) -> String {
    let table = header.find("xcscr_rules[XCSCR_RULES]").unwrap();
    let end = table + header[table..].find("\n};").unwrap();
    let fields: Vec<&str> = header[..end].rsplitn(4, ", ").collect();
    let [value, weight, action, before] = fields[..] else {
        panic!("no rule: {header}");
    };
    let other = if action == "0" { "1" } else { "0" };
    let after = &header[end..];
    format!("{before}, {other}, {weight}, {value}{after}")
}

#[test]
fn source_code_compiles_without_warnings_and_chooses_as_the_learner_in_every_percept() {
    use Target::{C99, Python};
    let cases = [
        (C99, "maze5", Method::XcscrPlus, Sensor::LidarPosition),
        (Python, "maze4", Method::XcscrPlus, Sensor::Neighbours),
        (C99, "maze6", Method::XcscrPlus, Sensor::Neighbours),
        (C99, "maze6", Method::Xcscr, Sensor::Neighbours),
        (C99, "maze6", Method::QLearning, Sensor::Neighbours),
        (C99, "maze6", Method::XcscrPlus, Sensor::NeighboursPosition),
        (Python, "maze4", Method::XcscrPlus, Sensor::Position),
    ];
    for (target, world, method, sensor) in cases.into_iter().take(rounds([2, 7, 7])) {
        let learned = learned(deciding(world, method, sensor));
        let (percepts, source) = (percepts(&learned.plan), text(&learned, target));
        let found = differences(&learned, &percepts, &chosen(target, &source, &percepts));
        let name = format!("{}, {method:?}, {sensor:?}", target.name());
        assert_eq!(found, 0, "{name}, {} percepts", percepts.len());
    }
}

#[test]
fn control_one_rule_with_another_action_is_found() {
    let learned = learned(deciding("maze6", Method::QLearning, Sensor::Neighbours));
    let forged = with_another_action(&text(&learned, Target::C99));
    let percepts = percepts(&learned.plan);
    let chosen = chosen(Target::C99, &forged, &percepts);
    assert!(differences(&learned, &percepts, &chosen) > 0);
}

#[test]
fn a_ballot_decides_as_the_learner_on_the_host_too() {
    let learned = learned(deciding("maze5", Method::AdaptedEven, Sensor::Neighbours));
    let (policy, percepts) = (policy(&learned).unwrap(), percepts(&learned.plan));
    let decide = |percept| {
        let action = policy.decide(percept);
        action.map_or(-1, |action| action.index() as i16)
    };
    let chosen: Vec<i16> = percepts.iter().map(decide).collect();
    assert_eq!(differences(&learned, &percepts, &chosen), 0);
}

#[test]
fn an_empty_table_is_refused() {
    let nothing = Knowledge::Table(Default::default());
    let refused = Policy::new(&nothing, 16, 4, &[]).unwrap_err();
    assert!(
        refused.to_string().contains("nothing was learned"),
        "{refused}"
    );
}

/// The policy of so many rules for the first action, all of which match the percept of zeros, and one for
/// each of two others, one of them better by `ahead`.
fn close_rules(many: usize, ahead: f64) -> Result<Policy, Error> {
    let rule = |condition: &str, action: u8, prediction: f64| {
        format!(
            r#"{{"condition":"{condition}","action":{action},"prediction":{prediction:?},
            "error":0.0,"fitness":1.0,"numerosity":1,"experience":1,"time_stamp":0,"set_size":1.0}}"#
        )
    };
    // The zeros of a number, and don't-cares for its ones.
    let of_number = |number: usize| format!("{number:016b}").replace('1', "#");
    let any = "#".repeat(16);
    let same = (0..many).map(|one| rule(&of_number(one), 0, 1000.0));
    let others = [rule(&any, 1, 1000.0 + ahead), rule(&any, 2, -1e6)];
    let rules: Vec<String> = same.chain(others).collect();
    let json = format!(r#"{{"rules":[{}]}}"#, rules.join(","));
    let knowledge: Knowledge = serde_json::from_str(&json).unwrap();
    let percepts = Sensor::Neighbours.percepts(&crate::kit::trial::maze("maze4"));
    Policy::new(&knowledge, 16, 4, &percepts)
}

#[test]
fn nearly_equal_values_need_few_bits_and_votes_whose_sums_do_not_fit_are_refused() {
    let ahead = 2.0;
    let refused = close_rules(300, ahead).unwrap_err();
    assert!(
        refused.to_string().contains("the sums of 302 rules"),
        "{refused}"
    );
    assert!(
        refused.to_string().contains("train with another seed"),
        "{refused}"
    );
    assert!(close_rules(200, ahead).is_ok(), "control: fewer rules");
    assert!(close_rules(300, 1.0).is_ok(), "control: nearly equal");
}
