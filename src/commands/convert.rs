//! `xcscr world convert`: converts ROS 2 maps to worlds, and worlds to maps.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use xcscr::ErrorKind;
use xcscr::picture::map_preview;
use xcscr::world::{Gridded, Gridding, Maze, OccupancyMap};

use super::choices;
use super::failure::Failure;
use super::output::OutputFile;
use super::results::Results;

/// Arguments of `world convert`.
#[derive(Debug, clap::Args)]
pub struct ConvertArgs {
    /// The map (.yaml, next to its image) or the world file (.json) to convert.
    input: PathBuf,
    /// The world file (.json) or the map (.yaml, with its image next to it) to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Edge of a cell in metres [default: one pixel].
    #[arg(long, value_name = "M", value_parser = metres)]
    cell: Option<f64>,
    /// Start of the episodes, in metres in the map frame [default: any free cell].
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    start: Option<Point>,
    /// Goal, in metres in the map frame.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    goal: Option<Point>,
    /// Treat unknown pixels as this.
    #[arg(long, value_name = "WHAT", default_value = "wall")]
    unknown: Unknown,
    /// Erase groups of at most this many connected occupied or unknown pixels.
    #[arg(long, value_name = "N", default_value_t = 0)]
    despeckle: usize,
    /// Turn the grid by this angle against the image, in degrees counter-clockwise, or `auto` for
    /// the main direction of the walls.
    #[arg(
        long,
        value_name = "auto|DEG",
        default_value = "0",
        value_parser = rotation,
        allow_negative_numbers = true
    )]
    rotate: Rotation,
    /// Lower left corner of the grid in metres from that of the image, or `auto` for the corner
    /// with the most open moves between cells that can reach the goal.
    #[arg(long, value_name = "auto|X,Y", default_value = "auto", value_parser = offset, allow_hyphen_values = true)]
    offset: Offset,
    /// Draw the map, the grid, the start and the goal into this SVG file.
    #[arg(long, value_name = "FILE")]
    preview: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
}

/// The interpretation of unknown pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Unknown {
    Wall,
    Free,
}

/// A point in the map frame, in metres.
#[derive(Debug, Clone, Copy)]
struct Point([f64; 2]);

fn point(text: &str) -> Result<Point, String> {
    let point = choices::numbers(text).map(Point);
    point.ok_or_else(|| "expected metres such as 1.5,-0.3".to_owned())
}

/// The direction of the grid: that of the walls, or an angle in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rotation {
    Auto,
    By(f64),
}

fn rotation(text: &str) -> Result<Rotation, String> {
    match (text, choices::numbers(text)) {
        ("auto", _) => Ok(Rotation::Auto),
        (_, Some([degrees])) => Ok(Rotation::By(degrees)),
        _ => Err("expected `auto`, or degrees such as 7.5".to_owned()),
    }
}

/// Parses the edge of a cell.
fn metres(text: &str) -> Result<f64, String> {
    let metres = choices::numbers(text).map(|[metres]| metres);
    metres.ok_or_else(|| "expected metres such as 0.5".to_owned())
}

/// The corner of the grid.
#[derive(Debug, Clone, Copy)]
enum Offset {
    Auto,
    At(Point),
}

fn offset(text: &str) -> Result<Offset, String> {
    match text {
        "auto" => Ok(Offset::Auto),
        _ => point(text)
            .map(Offset::At)
            .map_err(|_| "expected `auto`, or metres such as 0.1,-0.05".to_owned()),
    }
}

/// Converts in the direction that the file extensions determine.
pub fn run(args: &ConvertArgs, out: &mut Results) -> Result<(), Failure> {
    match (ending(&args.input).as_str(), ending(&args.output).as_str()) {
        ("yaml" | "yml", "json") => to_world(args, out),
        ("json", "yaml" | "yml") => to_map(args, out),
        _ => {
            let message = "give a map (.yaml) and a world to write (.json), or a world and a map";
            Err(Failure::new(ErrorKind::Usage, message))
        }
    }
}

fn ending(file: &Path) -> String {
    let ending = file.extension().unwrap_or_default().to_string_lossy();
    ending.to_ascii_lowercase()
}

/// Converts a map to a world.
fn to_world(args: &ConvertArgs, out: &mut Results) -> Result<(), Failure> {
    let world = OutputFile::free(&args.output, args.force)?;
    let preview = args.preview.as_deref();
    let preview = preview.map(|path| OutputFile::free(path, args.force));
    let preview = preview.transpose()?;
    let map = OccupancyMap::load(&args.input)?;
    let walls_rad = map.wall_direction_rad();
    let gridding = Gridding {
        cell_m: args.cell,
        start_m: args.start.map(|Point(at)| at),
        goal_m: args.goal.map(|Point(at)| at),
        yaw_rad: match args.rotate {
            Rotation::Auto => walls_rad,
            Rotation::By(degrees) => degrees.to_radians(),
        },
        despeckle: args.despeckle,
        offset_m: match args.offset {
            Offset::Auto => None,
            Offset::At(Point(at)) => Some(at),
        },
        unknown_is_free: args.unknown == Unknown::Free,
        name: world_name(&args.output),
    };
    print_map(&map, args.unknown, out)?;
    if walls_rad != 0.0 {
        let hint = match args.rotate {
            Rotation::Auto => "the grid is turned as well",
            Rotation::By(_) => "`--rotate auto` turns the grid as well",
        };
        writeln!(
            out,
            "        most walls are turned by {:.1} degrees against the image: {hint}",
            walls_rad.to_degrees()
        )?;
    }
    let gridded = gridding.of(&map)?;
    if let Some(file) = preview {
        let picture = map_preview(&gridded.maze, &map)
            .map_err(|fault| Failure::new(ErrorKind::BadData, fault))?;
        file.write(picture.as_bytes())?;
    }
    world.write(gridded.maze.to_json().as_bytes())?;
    print_world(&gridded, args, out)
}

/// Derives a valid world name from the file name.
fn world_name(file: &Path) -> String {
    let stem = file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    Maze::repaired_name(&stem)
}

fn print_map(map: &OccupancyMap, unknown: Unknown, out: &mut Results) -> Result<(), Failure> {
    let [free, occupied, unseen] = map.counts();
    let unknown = match unknown {
        Unknown::Wall => "wall",
        Unknown::Free => "free",
    };
    writeln!(
        out,
        "map     {} x {} pixels of {} m: {free} free, {occupied} occupied, {unseen} unknown (taken as {unknown})",
        map.width, map.height, map.resolution_m
    )?;
    if map.unknown_as_free > 0 {
        let count = map.unknown_as_free;
        writeln!(
            out,
            "        warning: {count} pixels have the grey level 205, with which Nav2 saves unknown \
             cells, and count as free: set `free_thresh` to 0.196"
        )?;
    }
    if map.disputed > 0 {
        let count = map.disputed;
        writeln!(
            out,
            "        warning: {count} pixels are at a threshold or have an opacity: releases of Nav2 \
             read them differently; here they are read as in ROS 2 Humble"
        )?;
    }
    Ok(())
}

fn print_world(gridded: &Gridded, args: &ConvertArgs, out: &mut Results) -> Result<(), Failure> {
    let (maze, file) = (&gridded.maze, &args.output);
    writeln!(
        out,
        "world   {} x {} cells of {} m, {} free: {}",
        maze.width(),
        maze.height(),
        maze.cell_size_m(),
        maze.free_cells().count(),
        file.display()
    )?;
    if gridded.offset_m != [0.0, 0.0] {
        let [x, y] = gridded.offset_m;
        writeln!(
            out,
            "        the grid begins {x:.3},{y:.3} m from the corner of the image"
        )?;
    }
    let asked = [args.start, args.goal].map(|asked| asked.map(|Point(at)| at));
    let cells = [maze.start(), maze.goals().first().copied()];
    for ((name, asked), cell) in ["start", "goal"].into_iter().zip(asked).zip(cells) {
        if let Some((cell, asked)) = cell.zip(asked) {
            let middle = maze.centre_m(cell);
            let moved_m = (middle - nalgebra::Point2::from(asked)).norm();
            writeln!(
                out,
                "{name:7} {:.3},{:.3} m, the middle of its cell, {moved_m:.3} m from the given point",
                middle.x, middle.y
            )?;
        }
    }
    if gridded.erased > 0 {
        let count = gridded.erased;
        writeln!(out, "        {count} pixels were erased as noise")?;
    }
    if gridded.cut_off > 0 {
        let count = gridded.cut_off;
        writeln!(
            out,
            "        {count} free cells from which no goal can be reached became walls"
        )?;
    }
    Ok(())
}

/// Converts a world to a map.
fn to_map(args: &ConvertArgs, out: &mut Results) -> Result<(), Failure> {
    refuse_options_of_maps(args)?;
    let image = args.output.with_extension("pgm");
    let files = [&image, &args.output];
    let [image_file, map_file] = files.map(|path| OutputFile::free(path, args.force));
    let (image_file, map_file) = (image_file?, map_file?);
    let maze = Maze::load(&args.input)?;
    let name = image.file_name().unwrap_or_default().to_string_lossy();
    let map = maze.to_map(&name);
    image_file.write(&map.image)?;
    map_file.write(map.yaml.as_bytes())?;
    let (map, image) = (args.output.display(), image.display());
    let pixels = if maze.is_from_map() {
        "the pixels of the map"
    } else {
        "one pixel per cell"
    };
    Ok(writeln!(out, "{map} and {image}: {pixels}")?)
}

/// Rejects options for maps: a world already has its cells, start and goal.
fn refuse_options_of_maps(args: &ConvertArgs) -> Result<(), Failure> {
    let given = [
        ("--cell", args.cell.is_some()),
        ("--start", args.start.is_some()),
        ("--goal", args.goal.is_some()),
        ("--unknown free", args.unknown == Unknown::Free),
        ("--rotate", args.rotate != Rotation::By(0.0)),
        ("--despeckle", args.despeckle > 0),
        ("--offset", matches!(args.offset, Offset::At(_))),
        ("--preview", args.preview.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => {
            let input = args.input.display();
            let message =
                format!("{option} is for maps, and {input} is a world: leave the option out");
            Err(Failure::new(ErrorKind::Usage, message))
        }
    }
}
