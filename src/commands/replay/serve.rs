//! `xcscr replay --serve`: links that open recordings in a viewer.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use xcscr::record::layout;
use xcscr::record::server::{Content, Server, foxglove_link, lichtblick_link};
use xcscr::world::Maze;

use crate::commands::failure::{Exit, Failure};
use crate::commands::source::Source;

/// A link opens at most so many files; the others can be dragged into the viewer.
const MOST_LINKED: usize = 10;

/// Serves until Ctrl-C.
pub fn run(files: &[PathBuf], port: u16, out: &mut impl Write) -> Result<(), Failure> {
    let (runs, episodes, maze) = sorted(files)?;
    let mut server = Server::bind(port).map_err(|cause| {
        let message = format!("cannot listen on port {port}: {cause}; choose another `--port`");
        Failure::new(Exit::Io, message)
    })?;
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stopped))?;
    }
    let groups = [
        ("Episodes", episodes, layout::of_episode(&maze)),
        ("The whole run", runs, layout::of_run(&maze)),
    ];
    for (what, files, layout) in groups {
        print_links(&mut server, what, &files, layout, out)?;
    }
    writeln!(out, "Serving on {}; Ctrl-C ends it.", server.origin())?;
    out.flush()?;
    Ok(server.run(|| stopped.load(Ordering::Relaxed))?)
}

/// Files of whole runs, files of episodes, and the maze of the first.
fn sorted(files: &[PathBuf]) -> Result<(Vec<PathBuf>, Vec<PathBuf>, Maze), Failure> {
    let (mut runs, mut episodes, mut maze) = (Vec::new(), Vec::new(), None);
    for file in files {
        let source = Source::of(file)?;
        maze.get_or_insert(source.plan.maze);
        match source.episode {
            None => runs.push(file.clone()),
            Some(_) => episodes.push(file.clone()),
        }
    }
    let nothing = || Failure::new(Exit::Usage, "there is nothing to serve");
    Ok((runs, episodes, maze.ok_or_else(nothing)?))
}

fn print_links(
    server: &mut Server,
    what: &str,
    files: &[PathBuf],
    layout: String,
    out: &mut impl Write,
) -> Result<(), Failure> {
    if files.is_empty() {
        return Ok(());
    }
    let layout = server.add("foxglove-layout.json", Content::Text(layout));
    let mut links = Vec::new();
    for file in files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        links.push(server.add(&name, Content::File(file.clone())));
    }
    let linked = &links[links.len().saturating_sub(MOST_LINKED)..];
    match (links.len(), linked.len()) {
        (all, some) if some < all => writeln!(out, "{what} (the last {some} of {all})")?,
        _ => writeln!(out, "{what}")?,
    }
    writeln!(out, "  Lichtblick  {}", lichtblick_link(linked, &layout))?;
    writeln!(out, "  Foxglove    {}", foxglove_link(linked))?;
    writeln!(out, "  layout      {layout}")?;
    Ok(())
}
