//! The keys of a study file, as documented for users.

use serde::Deserialize;

/// A key of a study file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct StudyKey {
    /// Its name.
    pub name: String,
    /// The kind of its value.
    pub kind: String,
    /// The default, in words; `None` if the key is required.
    pub default: Option<String>,
    /// Lines of a study file that use the key.
    pub example: String,
    /// The description.
    pub about: String,
}

impl StudyKey {
    /// Returns all keys of a study file, the required ones first.
    pub fn all() -> Vec<Self> {
        #[derive(Deserialize)]
        struct Keys {
            key: Vec<StudyKey>,
        }
        let keys = toml::from_str::<Keys>(include_str!("keys.toml"));
        keys.expect("the embedded list of keys is valid").key
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;

    /// Returns a study file with all required keys and the example of this key.
    fn with_example(key: &StudyKey) -> String {
        let required = StudyKey::all()
            .into_iter()
            .filter(|one| one.default.is_none());
        let others = required.filter(|one| one.name != key.name);
        let lines: Vec<String> = others.map(|one| one.example).collect();
        let methods = lines.join("\n").replace(r#", "xcscr-plus""#, "");
        format!("{methods}\n{}\n", key.example)
    }

    #[test]
    fn every_example_makes_a_study() {
        for key in StudyKey::all() {
            let text = with_example(&key);
            let study = frozen(&text, &[]);
            assert!(study.is_ok(), "{text}\n{study:?}");
        }
    }

    #[test]
    fn keys_without_a_default_are_required() {
        for key in StudyKey::all() {
            let text = with_example(&key).replace(&key.example, "");
            assert_eq!(
                frozen(&text, &[]).is_err(),
                key.default.is_none(),
                "{}: {text}",
                key.name
            );
        }
    }
}
