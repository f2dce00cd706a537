//! Randomly generated mazes: the same kind, size and seed give the same maze.

mod corridors;
mod dfs;
mod field;
mod random;
mod rooms;

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use self::field::Field;
use super::maze::Maze;
use crate::streams::StreamName;
use strum::{IntoStaticStr, VariantArray};
use xcs::bounds::{OutOfRange, within};
use xcs::random::Stream;

/// The allowed numbers of cells on each side of a generated maze.
const SIDES: RangeInclusive<u16> = 5..=1024;

/// The algorithm that generates a maze.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum MazeKind {
    /// Winding passages with dead ends and a single path between any two cells.
    Dfs,
    /// Rooms by recursive division, each wall with one door.
    Rooms,
    /// Obstacles scattered over a field.
    Random,
    /// Long parallel corridors, with two openings from each to the next.
    Corridors,
}

impl MazeKind {
    /// All kinds.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Returns the name used on the command line and in names of worlds.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// The complete description of a generated maze. Its text, such as `rooms-12-3`, is the name of the
/// maze.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recipe {
    /// The algorithm.
    pub kind: MazeKind,
    /// Cells on each side, including the border; 5 to 1024.
    pub size: u16,
    /// The root of its random stream.
    pub seed: u64,
}

impl Recipe {
    /// Generates the maze: square, with a closed border, four moves and cells of one metre. Every
    /// free cell is reachable. The start is the first free cell in reading order, the goal the one
    /// farthest from it.
    ///
    /// # Errors
    /// When the size is out of range.
    pub fn maze(&self) -> Result<Maze, OutOfRange> {
        within("size", self.size, SIDES)?;
        let mut stream = Stream::new(self.seed, StreamName::World);
        let mut field = Field::new(self.size);
        match self.kind {
            MazeKind::Dfs => dfs::carve(&mut field, &mut stream),
            MazeKind::Rooms => rooms::carve(&mut field, &mut stream),
            MazeKind::Random => random::carve(&mut field, &mut stream),
            MazeKind::Corridors => corridors::carve(&mut field, &mut stream),
        }
        Ok(field.into_maze(self.to_string()))
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, size, seed } = self;
        write!(f, "{}-{size}-{seed}", kind.name())
    }
}

/// The text is not a recipe.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected kind, size and seed, such as `rooms-12-3`")]
pub struct NoRecipe;

impl FromStr for Recipe {
    type Err = NoRecipe;

    fn from_str(text: &str) -> Result<Self, NoRecipe> {
        let mut parts = text.split('-');
        let mut next = || parts.next().ok_or(NoRecipe);
        let (kind, size, seed) = (next()?, next()?, next()?);
        let kind = MazeKind::ALL.iter().find(|one| one.name() == kind);
        let recipe = Self {
            kind: *kind.ok_or(NoRecipe)?,
            size: size.parse().map_err(|_| NoRecipe)?,
            seed: seed.parse().map_err(|_| NoRecipe)?,
        };
        // Each maze has exactly one name: no signs, no leading zeros, no extra parts.
        (recipe.to_string() == text)
            .then_some(recipe)
            .ok_or(NoRecipe)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::world::Paths;

    fn recipe() -> impl Strategy<Value = Recipe> {
        let kind = prop::sample::select(MazeKind::ALL);
        (kind, 5_u16..40, any::<u64>()).prop_map(|(kind, size, seed)| Recipe { kind, size, seed })
    }

    proptest! {
        #[test]
        fn a_generated_maze_is_a_world_file_in_which_every_free_cell_reaches_the_goal(
            recipe in recipe(),
        ) {
            let maze = recipe.maze().unwrap();
            prop_assert_eq!(&recipe.maze().unwrap(), &maze, "the same again");
            let text = maze.to_json();
            prop_assert_eq!(&Maze::from_json(text.as_bytes(), "x.json").unwrap(), &maze);
            let paths = Paths::new(&maze);
            for cell in maze.free_cells() {
                prop_assert!(paths.distance(&maze, cell).is_some(), "{}: {:?}", text, cell);
            }
            let start = maze.start().unwrap();
            prop_assert!(paths.distance(&maze, start) >= Some(2), "{}", text);
        }

        #[test]
        fn a_recipe_is_parsed_from_its_display(recipe in recipe()) {
            prop_assert_eq!(recipe.to_string().parse(), Ok(recipe));
        }
    }

    #[test]
    fn sizes_out_of_range_and_invalid_names_are_refused() {
        for size in [0, 4, 1025] {
            let kind = MazeKind::Dfs;
            assert!(
                Recipe {
                    kind,
                    size,
                    seed: 1
                }
                .maze()
                .is_err(),
                "{size}"
            );
        }
        for text in [
            "rooms",
            "rooms-12",
            "halls-12-3",
            "rooms-012-3",
            "rooms-12-3-4",
            "rooms-12--3",
        ] {
            assert_eq!(text.parse::<Recipe>(), Err(NoRecipe), "{text}");
        }
    }

    #[test]
    fn a_perfect_maze_has_one_path_to_each_cell() {
        let maze = "dfs-21-7".parse::<Recipe>().unwrap().maze().unwrap();
        let free = maze.free_cells().count();
        let joined = |cell| {
            let moves = maze.moves().directions().iter();
            moves
                .filter(|&&direction| maze.step(cell, direction).is_some())
                .count()
        };
        let joints: usize = maze.free_cells().map(joined).sum();
        assert_eq!(joints / 2, free - 1, "a tree");
    }
}
