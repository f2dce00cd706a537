//! Worlds that are bundled with the program, by name.
//!
//! The folder `worlds` of this crate is a link to that of the repository, so that a package contains it.

use std::path::Path;

use super::error::WorldError;
use super::maze::Maze;

/// Expands to the name and text of a world in the folder of classic mazes.
macro_rules! classic {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../worlds/classic/", $name, ".json")),
        )
    };
}

/// The bundled worlds: name and text.
const WORLDS: [(&str, &str); 35] = [
    ("maze4", include_str!("../../worlds/maze4.json")),
    ("maze5", include_str!("../../worlds/maze5.json")),
    ("maze5-wet", include_str!("../../worlds/maze5-wet.json")),
    ("maze6", include_str!("../../worlds/maze6.json")),
    (
        "maze6-classic",
        include_str!("../../worlds/maze6-classic.json"),
    ),
    ("woods1", include_str!("../../worlds/woods1.json")),
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

/// Returns the text of the world file of a bundled world.
pub fn bundled_world(name: &str) -> Option<&'static str> {
    let found = WORLDS.iter().find(|(known, _)| *known == name);
    found.map(|(_, text)| *text)
}

/// Returns the names of the bundled worlds.
pub fn bundled_worlds() -> impl Iterator<Item = &'static str> {
    WORLDS.iter().map(|(name, _)| *name)
}

impl Maze {
    /// Loads a world file by its path, or else a bundled world by its name.
    ///
    /// # Errors
    /// Those of [`Maze::load`].
    pub fn find(path: &Path) -> Result<Self, WorldError> {
        let bundled = path.to_str().and_then(bundled_world);
        match bundled.filter(|_| !path.exists()) {
            Some(text) => Self::from_json(text.as_bytes(), &path.to_string_lossy()),
            None => Self::load(path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bundled_worlds_are_found_by_name_from_any_folder() {
        let found = Maze::find("maze4".as_ref()).unwrap();
        assert_eq!(
            found,
            Maze::load("../../worlds/maze4.json".as_ref()).unwrap()
        );
        let fault = Maze::find("maze77".as_ref()).unwrap_err().to_string();
        assert!(fault.contains("did you mean"), "{fault}");
        assert!(fault.contains("maze7"), "{fault}");
    }
}
