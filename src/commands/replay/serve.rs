//! `xcscr replay --serve`: links that open recordings in a viewer.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use xcscr::record::Extent;
use xcscr::record::gate::Origin;
use xcscr::record::layout;
use xcscr::record::server::{Content, Server, foxglove_link, lichtblick_link};
use xcscr::run::Source;
use xcscr::trial::Plan;

use crate::commands::failure::{Exit, Failure};

/// A link opens at most so many files; the others can be dragged into the viewer.
const MOST_LINKED: usize = 10;

/// Serves until Ctrl-C.
pub fn run(
    files: &[PathBuf],
    port: u16,
    origins: &[Origin],
    out: &mut impl Write,
) -> Result<(), Failure> {
    let groups = sorted(files)?;
    let mut server = Server::bind(port).map_err(|cause| {
        let message = format!("cannot listen on port {port}: {cause}; choose another `--port`");
        Failure::new(Exit::Io, message)
    })?;
    origins.iter().for_each(|origin| server.allow(origin));
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stopped))?;
    }
    for group in &groups {
        print_links(&mut server, group, out)?;
    }
    writeln!(out, "Serving on {}; Ctrl-C ends it.", server.origin())?;
    out.flush()?;
    Ok(server.run(|| stopped.load(Ordering::Relaxed))?)
}

/// Recordings of one run that one layout fits: those of two runs would interleave in a viewer.
struct Group {
    plan: Plan,
    kind: Kind,
    files: Vec<PathBuf>,
}

/// What they show, in the order in which they are offered.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Story,
    Run,
    Episodes,
}

impl Group {
    fn name(&self) -> String {
        let what = match self.kind {
            Kind::Story => "The story of the run",
            Kind::Run => "The whole run",
            Kind::Episodes => "Episodes",
        };
        let (maze, config) = (&self.plan.maze, &self.plan.config);
        let (method, seed) = (config.method.name(), config.seed);
        format!("{what} in {}: {method}, seed {seed}", maze.name())
    }

    fn layout(&self) -> String {
        match self.kind {
            Kind::Run => layout::of_run(&self.plan.maze),
            Kind::Story | Kind::Episodes => layout::of_episode(&self.plan.maze),
        }
    }
}

/// The files run by run and kind by kind, stories first.
fn sorted(files: &[PathBuf]) -> Result<Vec<Group>, Failure> {
    let mut groups: Vec<Group> = Vec::new();
    for file in files {
        let source = Source::of(file)?;
        let plan = source.plan;
        let kind = match source.extent {
            Extent::Story => Kind::Story,
            Extent::Run => Kind::Run,
            Extent::Episode(_) => Kind::Episodes,
        };
        let fits = |group: &&mut Group| group.plan == plan && group.kind == kind;
        match groups.iter_mut().find(fits) {
            Some(group) => group.files.push(file.clone()),
            None => groups.push(Group {
                plan,
                kind,
                files: vec![file.clone()],
            }),
        }
    }
    groups.sort_by_key(|group| group.kind);
    Ok(groups)
}

fn print_links(server: &mut Server, group: &Group, out: &mut impl Write) -> Result<(), Failure> {
    let layout = server.add("foxglove-layout.json", Content::Text(group.layout()));
    let mut links = Vec::new();
    for file in &group.files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        links.push(server.add(&name, Content::File(file.clone())));
    }
    let what = group.name();
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
