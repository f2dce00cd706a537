//! Freezes a study file into a protocol.

use toml::Table;

use super::variants::{Variation, number_of_combinations, variants};
use super::{Arm, MOST_ARMS, MOST_GENERATED, MOST_WORLDS, Protocol, StudyFile};
use crate::Error;
use crate::agent::Method;
use crate::study::custom::Agents;
use crate::trial::{Resolved, Settings};
use crate::world::{Maze, Recipe};
use xcs::bounds::within;

pub fn freeze(file: &StudyFile, agents: &Agents) -> Result<Protocol, Error> {
    check_worlds(file)?;
    check_number(file, agents)?;
    let worlds = file.worlds()?;
    let protocol = Protocol {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        name: file.name.clone(),
        seed: file.seed,
        trials: file.trials,
        episodes: file.episodes,
        drives: file.drives,
        reference: file.reference.clone(),
        arms: arms(file, &worlds, agents)?,
        worlds,
    };
    protocol.check_numbers()?;
    match protocol.check() {
        Ok(()) => Ok(protocol),
        Err(fault) => Err(file.fault(fault)),
    }
}

/// Rejects too many worlds before any of them is created.
fn check_worlds(file: &StudyFile) -> Result<(), Error> {
    let names = &file.worlds;
    within("worlds", names.len(), 0..=MOST_WORLDS)?;
    let recipes = names.iter().filter_map(|name| name.parse::<Recipe>().ok());
    let cells = recipes.map(|recipe| usize::from(recipe.size).pow(2)).sum();
    within("cells of all generated worlds", cells, 0..=MOST_GENERATED)?;
    Ok(())
}

/// Rejects a study with too many combinations. A sweep alone can have billions.
fn check_number(file: &StudyFile, agents: &Agents) -> Result<(), Error> {
    let sensors = file.world_sensors.values().chain(&file.sensors);
    let number = [
        file.worlds.len(),
        file.arenas.len(),
        file.methods.len() + agents.names().count(),
        sensors.map(Vec::len).max().unwrap_or(1),
        file.without.len() + 1,
        number_of_combinations(file)?,
    ];
    let number = number.into_iter().fold(1, usize::saturating_mul);
    if number <= MOST_ARMS {
        return Ok(());
    }
    let fault = format!("it has {number} combinations, but the maximum is {MOST_ARMS}");
    Err(file.fault(fault))
}

/// Returns every combination, in the order of the file, worlds first, and custom agents after the methods.
fn arms(file: &StudyFile, worlds: &[Maze], agents: &Agents) -> Result<Vec<Arm>, Error> {
    file.check_worlds(worlds)?;
    let variants = variants(file)?;
    let mut arms = Vec::new();
    for maze in worlds {
        for &method in &file.methods {
            let common = settings(file, maze.name(), method)?;
            let own = override_with(&common, &file.origin, &file.method_settings(method))?;
            arms.extend(arms_of(file, maze, method, &own, &variants)?);
        }
        for name in agents.names() {
            // Its settings are those of no method.
            let method = Method::QLearning;
            let own = settings(file, maze.name(), method)?;
            let own = arms_of(file, maze, method, &own, &variants)?.into_iter();
            arms.extend(own.map(|arm| Arm {
                agent: Some(name.clone()),
                ..arm
            }));
        }
    }
    Ok(arms)
}

/// Returns the arms of a method with these settings in a world.
fn arms_of(
    file: &StudyFile,
    maze: &Maze,
    method: Method,
    settings: &Settings,
    variants: &[Variation],
) -> Result<Vec<Arm>, Error> {
    let base = Resolved::new(settings, &[], &file.sets)?.settings;
    let mut arms = Vec::new();
    for (table, variant) in variants {
        let settings = override_with(&base, &origin_of_variants(file), table)?;
        for &arena in &file.arenas {
            arms.extend(
                file.sensors(maze.name(), arena)
                    .into_iter()
                    .map(|sensor| Arm {
                        world: maze.name().to_owned(),
                        method,
                        arena,
                        sensor,
                        variant: variant.clone(),
                        settings: settings.clone(),
                        agent: None,
                    }),
            );
        }
    }
    Ok(arms)
}

/// Resolves the settings of all methods in a world: default < robot < study < world. Those of one
/// method and the command line override them.
fn settings(file: &StudyFile, world: &str, method: Method) -> Result<Settings, Error> {
    let common = override_with(&file.robot_settings(method)?, &file.origin, &file.settings)?;
    override_with(&common, &file.origin, &file.world_settings(world))
}

fn override_with(base: &Settings, origin: &str, table: &Table) -> Result<Settings, Error> {
    let text = table.to_string();
    Ok(Resolved::new(base, &[(origin, &text)], &[])?.settings)
}

/// Returns the origin of variant settings, for messages.
fn origin_of_variants(file: &StudyFile) -> String {
    match file.without.is_empty() {
        true => format!("{}, sweep", file.origin),
        false => format!("{}, sweep or without", file.origin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;

    fn protocol(text: &str, sets: &[&str]) -> Result<Protocol, Error> {
        let text = format!(
            "name = \"s\"\nworlds = [\"maze4\", \"maze5\"]\nmethods = [\"xcs\", \"xcscr\"]\ntrials = 3\nepisodes = 4\n{text}"
        );
        frozen(&text, sets)
    }

    #[test]
    fn a_sweep_tries_every_combination_in_every_world() {
        let study = protocol(
            "[sweep]\n\"xcs.alpha\" = [0.1, 0.2]\nxcs.ga = [true, false]\n",
            &[],
        )
        .unwrap();
        assert_eq!(study.arms.len(), 2 * 2 * 4);
        assert_eq!(
            study.arms[1].variant.to_string(),
            "xcs.alpha=0.1 xcs.ga=false"
        );
        assert!(!study.arms[1].settings.xcs.ga);
        assert_eq!(study.len(), 48);
    }

    #[test]
    fn a_list_of_tables_runs_each_and_a_name_stands_for_its_single_values() {
        let text = "[[sweep]]\nname = \"calm\"\nphysics.noise = 1.0\n[[sweep]]\nname = \"windy\"\nphysics.noise = 3.0\nxcs.beta = [0.1, 0.2]\n[[sweep]]\nxcs.mu = 0.1\n";
        let study = protocol(&format!("arenas = [\"physics\"]\n{text}"), &[]).unwrap();
        let arms = || study.arms[..4].iter();
        let names: Vec<String> = arms().map(|arm| arm.variant.to_string()).collect();
        let windy = ["name=windy xcs.beta=0.1", "name=windy xcs.beta=0.2"];
        assert_eq!(names, ["name=calm", windy[0], windy[1], "xcs.mu=0.1"]);
        let noises: Vec<f64> = arms().map(|arm| arm.settings.physics.noise).collect();
        assert_eq!(noises, [1.0, 3.0, 3.0, 1.0]);
    }

    #[test]
    fn a_study_that_is_too_large_or_sets_a_value_twice_is_refused_before_it_is_made() {
        let values = vec!["0.5"; 100].join(", ");
        let keys = ["xcs.beta", "xcs.mu", "xcs.chi", "xcs.delta", "xcs.alpha"];
        let billions = keys.map(|key| format!("\"{key}\" = [{values}]\n")).concat();
        let both = "without = [\"xcs.ga\"]\n[sweep]\n\"xcs.ga\" = [true, false]\n";
        for (text, sets, words) in [
            (
                &format!("[sweep]\n{billions}")[..],
                &[][..],
                "it has 40000000000 combinations, but the maximum is 2500",
            ),
            (both, &[], "in `sweep` and in `without`"),
            (
                "without = [\"xcs.ga\"]\n[sweep]\nname = \"no-ga\"\nxcs.ga = false\n",
                &[],
                "in `sweep` and in `without`",
            ),
            (
                "[sweep]\n\"xcs.beta\" = [0.1, 0.2, 0.1]\n",
                &[],
                "`sweep` has `xcs.beta=0.1` twice",
            ),
            (
                "[[sweep]]\nname = \"a\"\nxcs.mu = 0.1\n[[sweep]]\nname = \"a\"\nxcs.mu = 0.2\n",
                &[],
                "`sweep` has `name=a` twice",
            ),
            (
                "[sweep]\n\"xcs.beta\" = [0.1]\n",
                &["xcs.beta=1"],
                "leave it out of --set",
            ),
        ] {
            let fault = protocol(text, sets).unwrap_err().to_string();
            assert!(fault.contains(words), "{fault}");
        }
    }

    #[test]
    fn more_trials_than_can_be_listed_are_refused() {
        let text = "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 1000000\nepisodes = 1\n[sweep]\n\"xcs.beta\" = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0]\n";
        let fault = frozen(text, &[]).unwrap_err().to_string();
        let words = "`trials of all combinations` is 11000000";
        assert!(fault.contains(words), "{fault}");
    }

    #[test]
    fn settings_of_a_method_override_the_study_and_the_command_line_overrides_both() {
        let text = "[settings]\n\"xcs.chi\" = 0.1\n\"xcs.mu\" = 0.1\n[method-settings.xcscr]\nxcs.chi = 0.3\nxcs.alpha = 0.3\n";
        let study = protocol(text, &["xcs.alpha=0.4"]).unwrap();
        let figures = |arm: usize| {
            let xcs = &study.arms[arm].settings.xcs;
            (xcs.chi, xcs.mu, xcs.alpha)
        };
        assert_eq!(figures(0), (0.1, 0.1, 0.4));
        assert_eq!(figures(1), (0.3, 0.1, 0.4));
    }

    #[test]
    fn an_agent_has_the_settings_of_the_study_and_those_of_no_method() {
        let text = "name = 's'\nworlds = ['maze4', 'maze5']\nmethods = ['xcs', 'q-learning']\ntrials = 1\nepisodes = 1\n[world-settings.maze5]\nreward.goal = 5\n[method-settings.xcs]\nreward.goal = 6\n[method-settings.q-learning]\nreward.goal = 7\n";
        let file = StudyFile::parse(text, "s.toml", std::path::Path::new("")).unwrap();
        let agents = Agents::default().with("own", |_| unreachable!("no trial is run"));
        let arms = Protocol::new(&file, &agents.unwrap()).unwrap().arms;
        let names: Vec<&str> = arms.iter().map(Arm::method_name).collect();
        assert_eq!(names, ["xcs", "q-learning", "own"].repeat(2));
        assert_eq!(arms[2].settings, Settings::default());
        assert_eq!(arms[5].settings.reward.goal, 5.0);
    }

    #[test]
    fn the_same_replicate_has_the_same_seed_in_every_arm_and_no_other() {
        let study = protocol("", &[]).unwrap();
        let seeds: Vec<u64> = (0..study.len())
            .map(|trial| study.trial_seed(trial))
            .collect();
        assert_eq!(seeds[..3], seeds[3..6]);
        assert!(seeds[0] != seeds[1] && seeds[1] != seeds[2]);
    }

    #[test]
    fn the_id_changes_with_any_change_and_survives_a_round_trip() {
        let study = protocol("", &[]).unwrap();
        let text = serde_json::to_string_pretty(&study).unwrap();
        let again: Protocol = serde_json::from_str(&text).unwrap();
        assert_eq!((again.id(), &again), (study.id(), &study));
        assert_ne!(protocol("", &["xcs.beta=0.21"]).unwrap().id(), study.id());
    }
}
