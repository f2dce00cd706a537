//! Draws the occupancy map of an office as a ROS 2 map (PGM and YAML), like the result of a SLAM run.
//!
//! The map has 22 m x 18 m at 5 cm per pixel, rooms on both sides of a corridor, doors of 1.0 m, desks
//! and speckles.
//!
//! ```sh
//! cargo run --example draw_office_map -- office
//! cargo run -- world convert office/office.yaml --cell 0.5 --goal 14.0,12.5 -o office.json
//! cargo run -- train office.json --robot turtlebot3-burger --out office-run
//! ```

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use xcscr::xcs::random::Stream;

const WIDTH_PX: usize = 440;
const HEIGHT_PX: usize = 360;
const PX_PER_M: f64 = 20.0;
const FREE: u8 = 254;
const OCCUPIED: u8 = 0;

/// Grey levels, row by row from the north.
struct Map(Vec<u8>);

impl Map {
    /// Fills a rectangle, in metres from the south-western corner.
    fn fill(&mut self, [west, south]: [f64; 2], [east, north]: [f64; 2], grey: u8) {
        let px = |metres: f64| (metres * PX_PER_M).round() as usize;
        for y in px(south)..px(north).min(HEIGHT_PX) {
            let row = (HEIGHT_PX - 1 - y) * WIDTH_PX;
            self.0[row + px(west)..row + px(east).min(WIDTH_PX)].fill(grey);
        }
    }
}

fn office() -> Map {
    let mut map = Map(vec![OCCUPIED; WIDTH_PX * HEIGHT_PX]);
    map.fill([0.2, 0.2], [21.8, 17.8], FREE);
    // The corridor runs from west to east, with rooms to the south and north.
    for [south, north] in [[7.4, 7.6], [10.4, 10.6]] {
        map.fill([0.2, south], [21.8, north], OCCUPIED);
    }
    for (room, west) in [0.2, 5.6, 11.0, 16.4].into_iter().enumerate() {
        let door_west = west + 1.0 + 0.7 * room as f64;
        for [south, north, desk_south] in [[0.2, 7.4, 2.0], [10.6, 17.8, 14.0]] {
            map.fill([west + 5.2, south], [west + 5.4, north], OCCUPIED);
            map.fill(
                [west + 1.5, desk_south],
                [west + 3.1, desk_south + 0.8],
                OCCUPIED,
            );
        }
        map.fill([door_west, 7.4], [door_west + 1.0, 7.6], FREE);
        map.fill([door_west + 0.5, 10.4], [door_west + 1.5, 10.6], FREE);
    }
    // Single pixels, like stray lidar returns.
    let mut stream = Stream::new(1, 0_u64);
    for _ in 0..60 {
        map.0[stream.below(WIDTH_PX * HEIGHT_PX)] = OCCUPIED;
    }
    map
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("office".to_owned()));
    fs::create_dir_all(&folder)?;
    let header = format!("P5\n{WIDTH_PX} {HEIGHT_PX}\n255\n");
    fs::write(
        folder.join("office.pgm"),
        [header.as_bytes(), &office().0].concat(),
    )?;
    let yaml = "image: office.pgm\nresolution: 0.05\norigin: [-6.0, -4.0, 0.0]\nnegate: 0\n\
                occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    fs::write(folder.join("office.yaml"), yaml)?;
    println!("{}", folder.join("office.yaml").display());
    Ok(())
}
