//! Studies that are shipped with the program.

/// The studies, by name.
const STUDIES: [(&str, &str); 4] = [
    ("paper", include_str!("presets/paper.toml")),
    ("ablation", include_str!("presets/ablation.toml")),
    ("defaults", include_str!("presets/defaults.toml")),
    ("sensing", include_str!("presets/sensing.toml")),
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
    use toml::Table;

    use super::*;
    use crate::study::protocol::frozen;
    use crate::trial::flatten;

    #[test]
    fn the_settings_file_of_the_paper_has_the_settings_of_its_study() {
        let file: Table = include_str!("../../../assets/paper.toml").parse().unwrap();
        let study: Table = study("paper").unwrap().parse().unwrap();
        let settings = study["settings"].as_table().unwrap();
        assert_eq!(flatten(file), flatten(settings.clone()));
    }

    #[test]
    fn every_shipped_study_can_be_planned() {
        for (name, text) in STUDIES {
            let protocol = frozen(text, &[]).unwrap();
            assert!(!protocol.is_empty(), "{name}");
            assert!(
                protocol.unread().is_empty(),
                "{name}: {:?}",
                protocol.unread()
            );
        }
    }
}
