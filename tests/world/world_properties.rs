//! What holds for every maze, tried on random ones.

use proptest::prelude::*;
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Maze, Paths};
use xcscr::xcs::random::Stream;

/// The rows of a random world, each inner cell a wall with a chance of one in four.
fn rows(stream: &mut Stream, width: usize, height: usize, fixed_start: bool) -> Vec<Vec<u8>> {
    let mut rows = vec![vec![b'#'; width + 2]; height + 2];
    for row in &mut rows[1..=height] {
        row[1..=width].fill_with(|| if stream.chance(0.25) { b'#' } else { b'.' });
    }
    let goals = 1 + stream.below(2);
    let mut put = |letter| rows[1 + stream.below(height)][1 + stream.below(width)] = letter;
    if fixed_start {
        put(b'S');
    }
    put(b'G');
    // Every second world has two goals, if they are not in one cell.
    if goals > 1 {
        put(b'G');
    }
    rows
}

/// The floor of these rows: a free cell in four is slippery.
fn floor<S: AsRef<str>>(stream: &mut Stream, rows: &[S]) -> Vec<String> {
    let mut letter = |wall: char| match wall {
        '#' => '#',
        _ if stream.chance(0.25) => ['1', '3', '9'][stream.below(3)],
        _ => '.',
    };
    let rows = rows.iter().map(AsRef::as_ref);
    rows.map(|row: &str| row.chars().map(&mut letter).collect())
        .collect()
}

/// A random maze; about every second attempt at one gives a world without fault.
fn maze(seed: u64) -> Maze {
    let mut stream = Stream::new(seed, StreamName::World);
    loop {
        let (width, height) = (1 + stream.below(8), 1 + stream.below(8));
        let fixed_start = stream.chance(0.7);
        let rows = rows(&mut stream, width, height, fixed_start);
        let rows: Vec<_> = rows
            .iter()
            .map(|row| String::from_utf8_lossy(row))
            .collect();
        let (moves, wrap) = (4 + 4 * stream.below(2), stream.chance(0.5));
        let size = 0.1 + 9.9 * stream.unit();
        let floor = floor(&mut stream, &rows);
        let text = format!(
            r#"{{"cell_size_m": {size}, "moves": {moves}, "wrap": {wrap}, "rows": {rows:?}, "floor": {floor:?}}}"#
        );
        if let Ok(maze) = Maze::from_json(text.as_bytes(), "random.json") {
            return maze;
        }
    }
}

/// The cells that one move can lead to, once per move.
fn next_cells(maze: &Maze, cell: Cell) -> Vec<Cell> {
    let directions = maze.moves().directions().iter();
    directions.filter_map(|&d| maze.step(cell, d)).collect()
}

/// Counts shortest paths by walking all of them.
fn count_by_walking(maze: &Maze, paths: &Paths, cell: Cell) -> u64 {
    match paths.distance(maze, cell) {
        None => 0,
        Some(0) => 1,
        Some(distance) => next_cells(maze, cell)
            .into_iter()
            .filter(|&next| paths.distance(maze, next) == Some(distance - 1))
            .map(|next| count_by_walking(maze, paths, next))
            .sum(),
    }
}

proptest! {
    #[test]
    fn a_maze_that_is_written_and_read_again_is_the_same(seed: u64) {
        let maze = maze(seed);
        let text = maze.to_json();
        let again = Maze::from_json(text.as_bytes(), "again.json");
        prop_assert_eq!(again.map_err(|e| e.to_string()), Ok(maze), "{}", text);
    }

    #[test]
    fn a_distance_is_one_more_than_the_least_among_the_neighbours(seed: u64) {
        let maze = maze(seed);
        let paths = Paths::new(&maze);
        for cell in maze.free_cells() {
            let least = next_cells(&maze, cell)
                .into_iter()
                .filter_map(|next| paths.distance(&maze, next))
                .min();
            let expected = match maze.is_goal(cell) {
                true => Some(0),
                false => least.map(|steps| steps + 1),
            };
            let found = paths.distance(&maze, cell);
            prop_assert_eq!(found, expected, "{:?} in {}", cell, maze.to_json());
        }
    }

    #[test]
    fn counting_shortest_paths_agrees_with_walking_them(seed: u64) {
        let maze = maze(seed);
        let paths = Paths::new(&maze);
        for cell in maze.free_cells() {
            let expected = count_by_walking(&maze, &paths, cell);
            let found = paths.count_from(&maze, cell);
            prop_assert_eq!(found, expected, "{:?} in {}", cell, maze.to_json());
        }
    }
}
