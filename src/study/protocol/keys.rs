//! The keys of a study file, as documented for users.

/// A key of a study file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StudyKey {
    /// Its name.
    pub name: &'static str,
    /// The kind of its value.
    pub kind: &'static str,
    /// The default, in words; empty if the key is required.
    pub default: &'static str,
    /// Lines of a study file that use the key.
    pub example: &'static str,
    /// The description.
    pub about: &'static str,
}

/// All keys of a study file, the required ones first.
pub const STUDY_KEYS: [StudyKey; 19] = [
    StudyKey {
        name: "name",
        kind: "text",
        default: "",
        example: r#"name = "small""#,
        about: "The name of the study, which is the default name of its folder.",
    },
    StudyKey {
        name: "worlds",
        kind: "list of texts",
        default: "",
        example: r#"worlds = ["maze4", "rooms-12-3"]"#,
        about: "Bundled worlds, paths of world files relative to this file, or kind, size and seed of generated worlds.",
    },
    StudyKey {
        name: "methods",
        kind: "list of methods",
        default: "",
        example: r#"methods = ["xcs", "xcscr-plus"]"#,
        about: "The methods to compare.",
    },
    StudyKey {
        name: "trials",
        kind: "whole number",
        default: "",
        example: "trials = 30",
        about: "Trials of each combination. Trial n has the same seed in all of them.",
    },
    StudyKey {
        name: "episodes",
        kind: "whole number",
        default: "",
        example: "episodes = 180",
        about: "Episodes of each trial.",
    },
    StudyKey {
        name: "seed",
        kind: "whole number",
        default: "1",
        example: "seed = 7",
        about: "The root seed, which determines the seeds of all trials.",
    },
    StudyKey {
        name: "arenas",
        kind: "list of arenas",
        default: r#"["grid"]"#,
        example: r#"arenas = ["grid", "physics"]"#,
        about: "The arenas in which the robot moves.",
    },
    StudyKey {
        name: "sensors",
        kind: "list of sensors",
        default: "`neighbours` on the grid, `lidar` in physics",
        example: r#"sensors = ["neighbours", "position"]"#,
        about: "The sensors of the robot.",
    },
    StudyKey {
        name: "robot",
        kind: "text",
        default: "the default robot",
        example: "robot = \"turtlebot3-burger\"\narenas = [\"physics\"]",
        about: "The robot profile of all trials: a bundled name, or the path of a TOML file relative to this file.",
    },
    StudyKey {
        name: "settings",
        kind: "table",
        default: "none",
        example: "[settings]\nxcs.beta = 0.1",
        about: "Settings of all trials.",
    },
    StudyKey {
        name: "world-settings",
        kind: "table by world",
        default: "none",
        example: "[world-settings.maze4]\nreward.step_threshold = 80",
        about: "Settings in one world. They override those of all trials.",
    },
    StudyKey {
        name: "method-settings",
        kind: "table by method",
        default: "none",
        example: "[method-settings.xcs]\nxcs.beta = 0.1",
        about: "Settings of one method. They override those of worlds.",
    },
    StudyKey {
        name: "world-sensors",
        kind: "table of lists by world",
        default: "none",
        example: "[world-sensors]\nmaze4 = [\"position\"]",
        about: "The sensors in one world. They replace `sensors`.",
    },
    StudyKey {
        name: "sweep",
        kind: "table of lists",
        default: "none",
        example: "[sweep]\nxcs.beta = [0.1, 0.2]",
        about: "Settings with lists of values. The study runs every combination. With two settings, the report has a heat map.",
    },
    StudyKey {
        name: "variants",
        kind: "list of tables",
        default: "none",
        example: "[[variants]]\nxcs.beta = 0.1\n[[variants]]\nxcs.beta = 0.3",
        about: "Tables of settings. The study runs each table with every combination of the swept settings.",
    },
    StudyKey {
        name: "sample",
        kind: "whole number",
        default: "all",
        example: "sample = 2\n[sweep]\nxcs.beta = [0.1, 0.2, 0.3]",
        about: "How many combinations of `sweep` to run, drawn at random.",
    },
    StudyKey {
        name: "without",
        kind: "list of settings",
        default: "none",
        example: r#"without = ["xcs.action_set_subsumption"]"#,
        about: "Parts of a method to leave out, one at a time. A switch is turned off, and another setting takes the value after its `=`.",
    },
    StudyKey {
        name: "after",
        kind: "list of texts",
        default: "none",
        example: r#"after = ["nothing", "maze5"]"#,
        about: "Worlds in which trials learn beforehand, or `nothing`. The study runs each alternative.",
    },
    StudyKey {
        name: "drives",
        kind: "whole number",
        default: "0",
        example: "drives = 10",
        about: "Episodes in which the policy of each finished trial drives its robot, without learning or exploring.",
    },
];

/// Returns the names of all keys.
pub fn names() -> impl Iterator<Item = &'static str> + Clone {
    STUDY_KEYS.iter().map(|key| key.name)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::study::{Overrides, Protocol, StudyFile};

    /// Returns a study file with all required keys and the example of this key.
    fn with_example(key: &StudyKey) -> String {
        let required = STUDY_KEYS.iter().filter(|one| one.default.is_empty());
        let others = required.filter(|one| one.name != key.name);
        let lines: Vec<&str> = others.map(|one| one.example).collect();
        let methods = lines.join("\n").replace(r#", "xcscr-plus""#, "");
        format!("{methods}\n{}\n", key.example)
    }

    #[test]
    fn every_example_makes_a_study() {
        for key in &STUDY_KEYS {
            let text = with_example(key);
            let file = StudyFile::parse(&text, key.name, Path::new("."));
            let study = file.and_then(|file| Protocol::new(&file, &Overrides::default()));
            assert!(study.is_ok(), "{text}\n{study:?}");
        }
    }

    #[test]
    fn keys_without_a_default_are_required() {
        for key in &STUDY_KEYS {
            let text = with_example(key).replace(key.example, "");
            let file = StudyFile::parse(&text, "s.toml", Path::new("."));
            assert_eq!(
                file.is_err(),
                key.default.is_empty(),
                "{}: {text}",
                key.name
            );
        }
    }
}
