//! Worlds and studies that come with the program.

/// The worlds, by name.
const WORLDS: [(&str, &str); 5] = [
    ("maze4", include_str!("../../../worlds/maze4.json")),
    ("maze5", include_str!("../../../worlds/maze5.json")),
    ("maze6", include_str!("../../../worlds/maze6.json")),
    (
        "maze4-classic",
        include_str!("../../../worlds/maze4-classic.json"),
    ),
    ("woods1", include_str!("../../../worlds/woods1.json")),
];

/// The studies, by name.
const STUDIES: [(&str, &str); 6] = [
    ("paper", include_str!("presets/paper.toml")),
    ("ablation", include_str!("presets/ablation.toml")),
    ("plus", include_str!("presets/plus.toml")),
    ("repairs", include_str!("presets/repairs.toml")),
    ("transfer", include_str!("presets/transfer.toml")),
    ("starts", include_str!("presets/starts.toml")),
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
