//! `xcscr world`: checks, shows, describes and generates world files.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use serde::Serialize;
use xcscr::ErrorKind;
use xcscr::arena::Agreement;
use xcscr::picture::world_picture;
use xcscr::sensor::{AliasedCells, Sensor};
use xcscr::trial::{Bounds, PlanError, RobotProfile, Settings};
use xcscr::world::{Cell, Facts, Maze, MazeKind, Origin, Recipe};

use super::choices;
use super::convert::{self, ConvertArgs};
use super::failure::Failure;
use super::map;
use super::output::{OutputFile, print_json};
use super::results::Results;
use super::terminal::write_words;

/// The most cells of a list that are printed.
const MOST_LISTED: usize = 8;

/// Subcommands of `world`.
#[derive(Debug, Subcommand)]
pub enum WorldCommand {
    /// Check world files: one line for each valid file, one message for each invalid one.
    Check {
        /// World files.
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// Put this robot into each cell, without noise, and count wrong percepts and beams.
        #[arg(long, value_name = "NAME|FILE")]
        robot: Option<String>,
    },
    /// Draw a world in the terminal, or as a picture.
    Show {
        /// A world file.
        file: PathBuf,
        /// Picture to write in place of the drawing: an .svg file.
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Replace the picture if it exists.
        #[arg(long, requires = "output")]
        force: bool,
    },
    /// Show size, goals, shortest paths, and cells with the same percept.
    Info {
        /// A world file.
        file: PathBuf,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
        /// Show the fewest possible steps on average: for a robot that knows its cell, and for one that
        /// knows the world but not its start.
        #[arg(long)]
        bounds: bool,
        /// With `--bounds`: the percept of the robot; for lidar percepts, that of a perfect lidar.
        #[arg(long, default_value = Sensor::Neighbours.name(), requires = "bounds", value_parser = choices::sensor())]
        sensor: Sensor,
    },
    /// Generate a random maze and print it as a world file.
    Generate(GenerateArgs),
    /// Convert a ROS 2 map to a world, or a world to a map.
    Convert(ConvertArgs),
}

/// Arguments of `world generate`.
#[derive(Debug, clap::Args)]
pub struct GenerateArgs {
    /// Kind of maze: winding passages, rooms with doors, random obstacles, or corridors.
    #[arg(long, value_parser = choices::one_of(MazeKind::ALL, MazeKind::name))]
    kind: MazeKind,
    /// Number of cells on each side, 5 to 1024.
    #[arg(long, value_name = "N")]
    size: u16,
    /// Seed. The same seed gives the same maze.
    #[arg(long, default_value_t = 1, value_name = "S", value_parser = choices::seed)]
    seed: u64,
}

/// Runs a subcommand of `world`.
pub fn run(command: WorldCommand, out: &mut Results) -> Result<(), Failure> {
    match command {
        WorldCommand::Check { files, robot } => {
            let robot = robot.as_deref().map(RobotProfile::load).transpose()?;
            check(&files, robot.as_ref(), out)
        }
        WorldCommand::Show {
            file,
            output,
            force,
        } => {
            let maze = choices::world(&file)?;
            match output {
                Some(picture) => draw(&maze, &picture, force),
                None => Ok(write!(out, "{}", maze.drawn(|_| None))?),
            }
        }
        WorldCommand::Generate(GenerateArgs { kind, size, seed }) => {
            let maze = Recipe { kind, size, seed }.maze();
            let maze = maze.map_err(|fault| Failure::new(ErrorKind::Usage, fault.to_string()))?;
            Ok(write!(out, "{}", maze.to_json())?)
        }
        WorldCommand::Convert(args) => convert::run(&args, out),
        WorldCommand::Info {
            file,
            json,
            bounds,
            sensor,
        } => {
            let maze = choices::world(&file)?;
            let description = Description {
                bounds: bounds.then(|| Bounds::new(&maze, sensor)),
                ..Description::new(&maze)
            };
            if json {
                print_json(&description, out)
            } else {
                description.print(out)
            }
        }
    }
}

/// Writes the picture of a world.
fn draw(maze: &Maze, picture: &Path, force: bool) -> Result<(), Failure> {
    map::require_svg(picture)?;
    let file = OutputFile::free(picture, force)?;
    let facts = Facts::new(maze);
    let caption = format!(
        "{} x {} cells, {}",
        facts.width,
        facts.height,
        shortest(&facts)
    );
    file.write(world_picture(maze, caption)?.as_bytes())
}

fn check(
    files: &[PathBuf],
    robot: Option<&RobotProfile>,
    out: &mut Results,
) -> Result<(), Failure> {
    let mut check = |file: &PathBuf| {
        let maze = choices::world(file)?;
        write_words(out, &summary(file, &maze))?;
        robot.map_or(Ok(()), |robot| check_senses(&maze, robot, out))
    };
    if let [file] = files {
        return check(file);
    }
    let mut failures: Vec<ErrorKind> = Vec::new();
    for file in files {
        if let Err(failure) = check(file) {
            failure.print();
            failures.push(failure.kind());
        }
    }
    verdict(&failures, files.len())
}

/// Prints how well a robot without noise senses a world.
fn check_senses(maze: &Maze, robot: &RobotProfile, out: &mut Results) -> Result<(), Failure> {
    let params = robot.settings_over(&Settings::default())?.physics;
    let found = Agreement::measure(maze, &params, Sensor::Lidar).map_err(PlanError::from)?;
    let share = |part: u32, all: u32| 100.0 * f64::from(part) / f64::from(all.max(1));
    let text = format!(
        "{}, put down in {} cells without noise: {:.1} % of the percepts wrong, {:.1} % of the beams off",
        robot.name(),
        found.places,
        share(found.wrong_percepts, found.places),
        share(found.beams_off, found.beams),
    );
    Ok(write_words(out, &text)?)
}

/// Returns the failure for several files. Bad data takes precedence over missing and unreadable
/// files.
fn verdict(failures: &[ErrorKind], files: usize) -> Result<(), Failure> {
    let Some(&first) = failures.first() else {
        return Ok(());
    };
    let exit = if failures.contains(&ErrorKind::BadData) {
        ErrorKind::BadData
    } else {
        first
    };
    let message = format!("{} of {files} worlds cannot be used", failures.len());
    Err(Failure::new(exit, message))
}

fn summary(file: &Path, maze: &Maze) -> String {
    let facts = Facts::new(maze);
    format!(
        "{}: {}, {} x {} cells, {}",
        file.display(),
        facts.world,
        facts.width,
        facts.height,
        shortest(&facts)
    )
}

fn shortest(facts: &Facts) -> String {
    match (facts.optimal_steps, facts.optimal_paths) {
        (Some(steps), Some(1)) => format!("{steps} steps on 1 shortest path"),
        (Some(steps), Some(u64::MAX)) => format!("{steps} steps on countless shortest paths"),
        (Some(steps), Some(paths)) => format!("{steps} steps on {paths} shortest paths"),
        _ => format!(
            "{:.3} steps on average, at most {}",
            facts.mean_optimal_steps, facts.greatest_optimal_steps
        ),
    }
}

/// The description that `world info` prints.
#[derive(Debug, Serialize)]
struct Description {
    #[serde(flatten)]
    facts: Facts,
    /// `None` for mazes with too many cells to compare.
    look_alike: Option<Vec<LookAlike>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bounds: Option<Bounds>,
}

/// The groups of cells with the same percept of one sensor.
#[derive(Debug, Serialize)]
struct LookAlike {
    sensor: Sensor,
    groups: Vec<AliasedCells>,
}

impl Description {
    fn new(maze: &Maze) -> Self {
        Self {
            facts: Facts::new(maze),
            look_alike: (!maze.is_too_large()).then(|| LookAlike::of(maze)),
            bounds: None,
        }
    }

    fn print(&self, out: &mut Results) -> Result<(), Failure> {
        let facts = &self.facts;
        let (width, height, size) = (facts.width, facts.height, facts.cell_size_m);
        let edges = if facts.wrap { ", joined edges" } else { "" };
        let start = facts.start.map_or("random".to_owned(), place);
        writeln!(out, "name        {}", facts.world)?;
        writeln!(
            out,
            "size        {width} x {height} cells of {size} m{edges}"
        )?;
        if let Some(Origin { x_m, y_m, yaw_rad }) = facts.origin {
            writeln!(
                out,
                "origin      {x_m}, {y_m} m, turned by {yaw_rad} rad, in the map frame"
            )?;
        }
        writeln!(out, "moves       {}", facts.moves)?;
        writeln!(out, "free cells  {}", facts.free_cells)?;
        for floor in &facts.floors {
            let (friction, cells) = (floor.friction, floor.cells);
            writeln!(out, "floor       friction {friction} in {cells} cells")?;
        }
        writeln!(out, "start       {start}")?;
        writeln!(out, "goals       {}", places(&facts.goals))?;
        writeln!(out, "shortest    {}", shortest(facts))?;
        match &self.look_alike {
            Some(all) => all.iter().try_for_each(|one| one.print(out))?,
            None => writeln!(out, "aliased     not searched in a maze of so many cells")?,
        }
        self.bounds
            .iter()
            .try_for_each(|bounds| print_bounds(bounds, out))
    }
}

/// Prints the bounds, each with its assumption.
fn print_bounds(bounds: &Bounds, out: &mut Results) -> Result<(), Failure> {
    let name = bounds.sensor.name();
    writeln!(
        out,
        "bounds      mean steps at best from all starts, percept {name}"
    )?;
    writeln!(
        out,
        "  full           {:.3}: the cell is known",
        bounds.full
    )?;
    let unknown_start = bounds
        .unknown_start
        .map_or("unknown".to_owned(), |steps| format!("{steps:.3}"));
    writeln!(
        out,
        "  unknown start  {unknown_start}: the world is known, the start is not"
    )?;
    Ok(())
}

impl LookAlike {
    /// Returns the groups of each sensor.
    fn of(maze: &Maze) -> Vec<Self> {
        let one = |&sensor: &Sensor| Self {
            sensor,
            groups: sensor.aliased_cells(maze),
        };
        Sensor::ALL.iter().map(one).collect()
    }

    fn print(&self, out: &mut Results) -> Result<(), Failure> {
        let name = self.sensor.name();
        if self.groups.is_empty() {
            return Ok(writeln!(out, "aliased     ({name}) none")?);
        }
        for group in self.groups.iter().take(MOST_LISTED) {
            let note = if group.share_a_best_action {
                "one move is best in all"
            } else {
                "no move is best in all"
            };
            let cells = places(&group.cells);
            write_words(out, &format!("aliased     ({name}) {cells}: {note}"))?;
        }
        match self.groups.len().saturating_sub(MOST_LISTED) {
            0 => Ok(()),
            1 => Ok(writeln!(out, "aliased     ({name}) and another group")?),
            more => Ok(writeln!(
                out,
                "aliased     ({name}) and {more} more groups"
            )?),
        }
    }
}

/// Formats a cell as column and row.
fn place(cell: Cell) -> String {
    format!("{},{}", cell.col, cell.row)
}

/// Formats cells as column and row, at most [`MOST_LISTED`] of them.
fn places(cells: &[Cell]) -> String {
    let shown: Vec<String> = cells.iter().copied().take(MOST_LISTED).map(place).collect();
    match cells.len().saturating_sub(MOST_LISTED) {
        0 => shown.join("  "),
        more => format!("{}  and {more} more", shown.join("  ")),
    }
}
