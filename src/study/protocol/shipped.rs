//! Worlds and studies that come with the program.

/// The text of a world of the folder of classic mazes, with its name.
macro_rules! classic {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../../worlds/classic/", $name, ".json")),
        )
    };
}

/// The worlds, by name.
const WORLDS: [(&str, &str); 37] = [
    ("maze4", include_str!("../../../worlds/maze4.json")),
    ("maze5", include_str!("../../../worlds/maze5.json")),
    (
        "maze5-helped",
        include_str!("../../../worlds/maze5-helped.json"),
    ),
    (
        "maze5-lured",
        include_str!("../../../worlds/maze5-lured.json"),
    ),
    ("maze5-wet", include_str!("../../../worlds/maze5-wet.json")),
    ("maze6", include_str!("../../../worlds/maze6.json")),
    (
        "maze6-classic",
        include_str!("../../../worlds/maze6-classic.json"),
    ),
    ("woods1", include_str!("../../../worlds/woods1.json")),
    classic!("cassandra4x4"),
    classic!("lab1"),
    classic!("littman57"),
    classic!("littman89"),
    classic!("maze10"),
    classic!("maze4-classic"),
    classic!("maze5-classic"),
    classic!("maze7"),
    classic!("mazea"),
    classic!("mazeb"),
    classic!("mazed"),
    classic!("mazee1"),
    classic!("mazee2"),
    classic!("mazee3"),
    classic!("mazef1"),
    classic!("mazef2"),
    classic!("mazef3"),
    classic!("mazef4"),
    classic!("mazef8"),
    classic!("mazef9"),
    classic!("miyazakia"),
    classic!("miyazakib"),
    classic!("sutton"),
    classic!("woods1-walled"),
    classic!("woods100"),
    classic!("woods101"),
    classic!("woods101demi"),
    classic!("woods102"),
    classic!("woods14"),
];

/// The studies, by name.
const STUDIES: [(&str, &str); 15] = [
    ("paper", include_str!("presets/paper.toml")),
    ("paper-search", include_str!("presets/paper-search.toml")),
    ("ablation", include_str!("presets/ablation.toml")),
    ("plus", include_str!("presets/plus.toml")),
    ("repairs", include_str!("presets/repairs.toml")),
    ("repairs-map", include_str!("presets/repairs-map.toml")),
    (
        "repairs-aliased",
        include_str!("presets/repairs-aliased.toml"),
    ),
    ("transfer", include_str!("presets/transfer.toml")),
    ("starts", include_str!("presets/starts.toml")),
    ("aliased", include_str!("presets/aliased.toml")),
    ("sensing", include_str!("presets/sensing.toml")),
    ("faults", include_str!("presets/faults.toml")),
    ("arenas", include_str!("presets/arenas.toml")),
    ("auxiliary", include_str!("presets/auxiliary.toml")),
    ("coevolved", include_str!("presets/coevolved.toml")),
];

/// The text of a world file that comes with the program.
pub fn world(name: &str) -> Option<&'static str> {
    find(&WORLDS, name)
}

/// The text of a study file that comes with the program.
pub fn study(name: &str) -> Option<&'static str> {
    find(&STUDIES, name)
}

/// The names of the worlds that come with the program.
pub fn world_names() -> String {
    names(&WORLDS)
}

/// The names of the studies that come with the program.
pub fn study_names() -> String {
    names(&STUDIES)
}

fn names(list: &[(&str, &str)]) -> String {
    let names: Vec<&str> = list.iter().map(|(name, _)| *name).collect();
    names.join(", ")
}

fn find(list: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    list.iter()
        .find(|(known, _)| *known == name)
        .map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::study::protocol::{Overrides, Protocol, StudyFile};

    #[test]
    fn every_study_that_comes_with_the_program_can_be_planned() {
        for (name, text) in STUDIES {
            let file = StudyFile::parse(text, name, Path::new("."));
            let protocol = file.and_then(|file| Protocol::new(&file, &Overrides::default()));
            assert!(protocol.is_ok_and(|plan| !plan.is_empty()), "{name}");
        }
    }
}
