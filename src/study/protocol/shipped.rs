//! Studies that are shipped with the program.

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

/// Returns the text of a shipped study file.
pub fn study(name: &str) -> Option<&'static str> {
    let study = STUDIES.iter().find(|(known, _)| *known == name);
    study.map(|(_, text)| *text)
}

/// Returns the names of the shipped studies.
pub fn names() -> impl Iterator<Item = &'static str> {
    STUDIES.iter().map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;

    #[test]
    fn every_shipped_study_can_be_planned() {
        for (name, text) in STUDIES {
            let protocol = frozen(text, &[]);
            assert!(protocol.is_ok_and(|plan| !plan.is_empty()), "{name}");
        }
    }
}
