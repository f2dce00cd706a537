//! From the pixels of a map to the cells of a world.

use xcscr::world::{Gridding, MapError, Maze};

use crate::kit::chance::rounds;
use crate::world::maps::{Map, plain, rows};

/// A map of square cells, `cell` pixels wide, each with a black pixel in its upper left corner
/// unless `is_free` says otherwise of its column and row.
fn spotted(side: usize, cell: usize, is_free: impl Fn(usize, usize) -> bool) -> Map {
    let pixels = side * cell;
    let mut pgm = format!("P5 {pixels} {pixels} 255\n").into_bytes();
    for (row, col) in (0..pixels).flat_map(|row| (0..pixels).map(move |col| (row, col))) {
        let is_spot = row % cell == 0 && col % cell == 0 && !is_free(col / cell, row / cell);
        pgm.push(if is_spot { 0 } else { 254 });
    }
    let map = Map(tempfile::tempdir().unwrap());
    map.keep("map.pgm", &pgm);
    map.yaml("");
    map
}

/// Every black pixel counts, and the grid is not shifted.
fn strict() -> Gridding {
    Gridding {
        yaw_rad: 0.0,
        despeckle: 0,
        offset_m: Some([0.0, 0.0]),
        ..plain()
    }
}

#[test]
fn a_cell_is_free_if_nothing_is_in_its_disc_and_a_ring_of_walls_closes_the_rest() {
    let free = "        ";
    let map = Map::drawn(&[free, free, "  #     ", free, "??      ", "??      "]);
    let gridded = map.gridded(0.2, None, [0.7, 0.1]).unwrap();
    assert_eq!(
        rows(&gridded.maze),
        ["######", "#....#", "#.#..#", "##..G#", "######"]
    );
    assert_eq!((gridded.maze.cell_size_m(), gridded.cut_off), (0.2, 0));
}

/// The pose of a world's corner is this, to rounding.
#[track_caller]
fn assert_origin(maze: &Maze, expected: [f64; 3]) {
    let found: [f64; 3] = maze.origin().into();
    let is_near = |(found, expected): (&f64, &f64)| (found - expected).abs() < 1e-9;
    let are_near = found.iter().zip(&expected).all(is_near);
    assert!(are_near, "{found:?}, not {expected:?}");
}

#[test]
fn a_world_keeps_the_pose_of_its_corner_in_the_maps_frame_and_points_are_metres_of_it() {
    let map = Map::drawn(&["    ##", "    ##", "      ", "?     "]);
    // The ring of walls begins one cell below and to the left of the image.
    let maze = map.gridded(0.2, None, [0.3, 0.1]).unwrap().maze;
    assert_origin(&maze, [-0.2, -0.2, 0.0]);
    // A quarter turn to the left: what was to the left is below, and what was below to the right.
    map.yaml("origin: [5.0, 1.0, 1.5707963267948966]");
    let maze = map.gridded(0.2, None, [4.9, 1.3]).unwrap().maze;
    assert_origin(&maze, [5.2, 0.8, std::f64::consts::FRAC_PI_2]);
    // The frame of the world and that of the map agree on the cell of the goal.
    let there = maze.centre_m(maze.goals()[0]);
    let off = (there.x - 4.9).abs().max((there.y - 1.3).abs());
    assert!(off < 1e-9, "{there}");
    // A point so far to the right in a turned image lies so far up in the frame.
    let turned = Map::drawn(&["      ", "      ", "      "]);
    turned.yaml("origin: [5.0, 1.0, 1.5707963267948966]");
    let gridded = turned.gridded(0.1, Some([4.95, 1.05]), [4.75, 1.55]);
    let expected = ["#.....G#", "#......#", "#S.....#"];
    assert_eq!(rows(&gridded.unwrap().maze)[1..4], expected);
    // What is cut off moves the corner.
    map.yaml("");
    let row = [0, 0, 0, 0, 254, 254];
    map.keep("map.pgm", &[&b"P5 6 2 255\n"[..], &row, &row].concat());
    let alone = map.gridded(0.1, None, [0.45, 0.05]).unwrap().maze;
    assert_origin(&alone, [0.3, -0.1, 0.0]);
}

#[test]
fn a_door_in_which_no_cell_fits_is_named_with_place_and_width() {
    let rows = [
        "####################",
        "#        ##        #",
        "#        ##        #",
        "#        ##        #",
        "#                  #",
        "#        ##        #",
        "#        ##        #",
        "####################",
    ];
    let map = Map::drawn(&rows);
    let cut = map.gridded(0.3, Some([0.4, 0.4]), [1.6, 0.4]).unwrap_err();
    let text = cut.to_string();
    let is_told = text.contains("0.10 m wide") && text.contains("--cell");
    assert!(is_told, "{text}");
    let MapError::CutOff(Some(Some(found))) = cut else {
        panic!("{text}")
    };
    let (x, y) = (found.at.x, found.at.y);
    assert!((0.9..1.1).contains(&x) && (0.3..0.4).contains(&y), "{text}");
    // Cells as small as the door pass through it.
    assert!(map.gridded(0.1, Some([0.4, 0.4]), [1.6, 0.4]).is_ok());
    // Without a start, what is cut off becomes wall, and is counted.
    let gridded = map.gridded(0.3, None, [1.6, 0.4]).unwrap();
    assert!(gridded.cut_off > 0);
}

#[test]
fn start_and_goal_in_the_only_free_cell_are_refused() {
    let refused = |map: &Map, start, goal, told: &str| {
        let refused = map.gridded(0.1, start, goal).unwrap_err().to_string();
        assert!(refused.contains(told), "{refused}");
    };
    let told = "in the cell of the goal";
    for rows in [&[" "][..], &["###", "# #", "###"]] {
        let map = Map::drawn(rows);
        let middle = [0.05 * rows.len() as f64; 2];
        refused(&map, Some(middle), middle, told);
        let alone = map.gridded(0.1, None, middle).unwrap_err();
        let is_cut_off = matches!(&alone, MapError::CutOff(None));
        assert!(is_cut_off, "{alone}");
    }
    let map = Map::drawn(&["   "]);
    refused(&map, Some([0.05, 0.05]), [0.06, 0.06], told);
    let apart = map.gridded(0.1, Some([0.05, 0.05]), [0.15, 0.05]);
    assert!(apart.is_ok(), "control");
}

#[test]
fn the_widest_way_through_a_hundred_thousand_rooms_is_found() {
    // Rooms meet in the pixels of the cells between them, in none of which a cell fits.
    const SIDE: usize = 480;
    let map = spotted(SIDE, 2, |col, row| (col + row) % 2 == 0);
    let far = 0.2 * SIDE as f64 - 0.1;
    let gridding = Gridding {
        cell_m: Some(0.2),
        start_m: Some([far, 0.1]),
        goal_m: Some([0.1, far]),
        ..strict()
    };
    let cut = gridding.of(&map.load().unwrap()).unwrap_err();
    let MapError::CutOff(Some(Some(found))) = &cut else {
        panic!("{cut}")
    };
    assert!((found.width_m - 0.1).abs() < 1e-9, "{cut}");
}

#[test]
fn a_map_without_a_goal_is_refused_with_the_option_that_gives_one() {
    let map = Map::drawn(&["   ", "   "]);
    let refused = plain().of(&map.load().unwrap()).unwrap_err();
    assert!(matches!(refused, MapError::NoGoal), "{refused}");
    assert!(refused.to_string().contains("--goal X,Y"), "{refused}");
    assert!(map.gridded(0.1, None, [0.15, 0.15]).is_ok(), "control");
}

/// An office as a grid of half-metre cells, drawn at 5 cm a pixel, with noise.
struct Office {
    cols: usize,
    rows: usize,
    walls: Vec<bool>,
}

impl Office {
    const CELL: usize = 10;

    /// Six rooms on both sides of a corridor, each with a door of two cells.
    fn new() -> Self {
        let (cols, rows) = (44, 36);
        let is_wall = |at: usize| {
            let (col, row) = (at % cols, at / cols);
            let border = col == 0 || row == 0 || col + 1 == cols || row + 1 == rows;
            let across = [14, 21].contains(&row) && !(6..8).contains(&(col % 14));
            let between = col % 14 == 0 && !(14..=21).contains(&row);
            border || across || between
        };
        let walls = (0..cols * rows).map(is_wall).collect();
        Self { cols, rows, walls }
    }

    /// The map, with some black pixels to the left and above, and black pixels among `noise`.
    fn map(&self, [left, above]: [usize; 2], noise: usize) -> Map {
        let width = self.cols * Self::CELL + left;
        let height = self.rows * Self::CELL + above;
        let mut dice = crate::kit::chance::dice(3);
        let mut pgm = format!("P5 {width} {height} 255\n").into_bytes();
        for (row, col) in (0..height).flat_map(|row| (0..width).map(move |col| (row, col))) {
            let inside = row.checked_sub(above).zip(col.checked_sub(left));
            let is_free = inside.is_some_and(|(row, col)| {
                !self.walls[row / Self::CELL * self.cols + col / Self::CELL]
            });
            let is_noise = noise > 0 && dice.below(noise) == 0;
            pgm.push(if is_free && !is_noise { 254 } else { 0 });
        }
        let map = Map(tempfile::tempdir().unwrap());
        map.keep("map.pgm", &pgm);
        map.yaml("resolution: 0.05");
        map
    }

    /// The office as rows without start and goal.
    fn drawn(&self) -> Vec<String> {
        let letter = |&wall: &bool| if wall { '#' } else { '.' };
        let rows = self.walls.chunks(self.cols);
        rows.map(|row| row.iter().map(letter).collect()).collect()
    }
}

fn unmarked(maze: &Maze) -> Vec<String> {
    let rows = rows(maze);
    rows.iter()
        .map(|row| row.replace(['S', 'G'], "."))
        .collect()
}

#[test]
fn erased_noise_does_not_make_walls_and_a_door_of_one_metre_is_found_with_half_metre_cells() {
    let office = Office::new();
    let cases = [([3, 7], 0), ([3, 7], 200), ([0, 0], 200), ([9, 1], 300)];
    for (shift, noise) in cases.into_iter().take(rounds([2, 4, 4])) {
        let map = office.map(shift, noise);
        let x = 0.05 * shift[0] as f64;
        let gridding = Gridding {
            cell_m: Some(0.5),
            goal_m: Some([x + 2.25, 2.25]),
            start_m: Some([x + 19.75, 15.25]),
            despeckle: 2,
            ..plain()
        };
        let loaded = map.load().unwrap();
        let gridded = gridding.of(&loaded).unwrap();
        let what = format!("{shift:?}, noise {noise}");
        // Noise that touches a wall stays, but a small robot passes it.
        let maze = gridded.maze.for_robot(0.15).unwrap();
        assert_eq!(unmarked(&maze), office.drawn(), "{what}");
        assert_origin(&maze, [x, 0.0, 0.0]);
        // Control: noise that is not erased closes cells.
        let strict = Gridding {
            despeckle: 0,
            ..gridding
        };
        let strict = strict.of(&loaded).ok();
        let strict = strict.and_then(|it| it.maze.for_robot(0.15));
        let is_drawn = strict.is_some_and(|maze| unmarked(&maze) == office.drawn());
        assert_eq!(is_drawn, noise == 0, "{what}");
    }
}

#[test]
fn the_thinnest_wall_stays_a_wall() {
    // Two rooms, and between them a wall of one pixel, straight or slanted.
    for slant in 0..4 {
        let wall = |row: usize| 14 + row * slant / 4;
        let draw = |row: usize| -> String {
            let from = wall(row.saturating_sub(1)).min(wall(row));
            let black = wall(row) + 1 - from;
            format!(
                "{}{}{}",
                " ".repeat(from),
                "#".repeat(black),
                " ".repeat(39 - wall(row))
            )
        };
        let drawn: Vec<String> = (0..20).map(draw).collect();
        let drawn: Vec<&str> = drawn.iter().map(String::as_str).collect();
        let map = Map::drawn(&drawn);
        let cut = map.gridded(1.0, Some([0.5, 0.5]), [3.5, 0.5]);
        let text = format!("slant {slant}: {cut:?}");
        assert!(matches!(cut, Err(MapError::CutOff(_))), "{text}");
    }
}

#[test]
fn despeckle_and_offset_do_what_they_say() {
    // Two pixels that touch across a corner in one cell of 4 x 4 pixels, and one in another.
    let free = "        ";
    let (first, second, third) = (" #      ", "  #     ", "       #");
    let map = Map::drawn(&[free, first, second, free, free, third, free, free]);
    let loaded = map.load().unwrap();
    let gridding = Gridding {
        cell_m: Some(0.4),
        goal_m: Some([0.1, 0.1]),
        ..strict()
    };
    let drawn = |gridding: &Gridding| gridding.of(&loaded).map(|it| rows(&it.maze)).unwrap();
    let with = |despeckle| Gridding {
        despeckle,
        ..gridding.clone()
    };
    let alone = gridding.of(&loaded).unwrap_err();
    assert!(matches!(alone, MapError::CutOff(_)), "{alone}");
    let [some, all] = [
        ["####", "##.#", "#G.#", "####"],
        ["####", "#..#", "#G.#", "####"],
    ];
    assert_eq!(drawn(&with(1)), some);
    assert_eq!(drawn(&with(2)), all);
    // Cells beyond the image are walls; a shift by whole cells changes nothing.
    for x in [-0.2, 0.2, 1.0] {
        let shifted = Gridding {
            offset_m: Some([x, 0.0]),
            goal_m: Some([0.3, 0.1]),
            ..with(2)
        };
        let gridded = shifted.of(&loaded).unwrap();
        assert_eq!(rows(&gridded.maze), ["###", "#.#", "#G#", "###"]);
        let [left, _] = gridded.offset_m;
        assert!((left + 0.2).abs() < 1e-9, "{left}");
        let x_m = gridded.maze.origin().x_m;
        assert!((x_m + 0.2).abs() < 1e-9, "{x_m}");
    }
}

#[test]
fn cells_that_cannot_reach_the_goal_become_walls_also_with_a_start() {
    let map = Map::drawn(&["  # ", "  # "]);
    let gridded = map.gridded(0.1, Some([0.05, 0.05]), [0.15, 0.05]).unwrap();
    assert_eq!(rows(&gridded.maze), ["####", "#..#", "#SG#", "####"]);
    assert_eq!(gridded.cut_off, 2);
}
