//! `xcscr replay`: prints links that open recordings in a viewer.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use xcscr::record::RecordingKind;
use xcscr::record::layout;
use xcscr::record::reader::Recording;
use xcscr::record::server::{Content, Origin, Server, foxglove_link, lichtblick_link};
use xcscr::run::Source;
use xcscr::trial::Plan;

use super::browser;
use crate::commands::failure::{Exit, Failure};
use crate::commands::terminal::write_link;

/// The most files that a link opens. The others can be dragged into the viewer.
const MOST_LINKED: usize = 10;

/// The options of the server.
pub struct Service<'a> {
    /// The port; 0 for any that is free.
    pub port: u16,
    /// Origins whose pages may read the recordings, in addition to those of the two viewers.
    pub origins: &'a [Origin],
    /// True if the first link is opened.
    pub open: bool,
}

/// Recordings that one link opens together.
pub struct Offer {
    /// A description of the recordings.
    pub what: String,
    /// The layout for the recordings.
    pub layout: String,
    /// The recordings.
    pub files: Vec<PathBuf>,
}

/// Serves until Ctrl-C.
pub fn run(offers: Vec<Offer>, service: &Service<'_>, out: &mut impl Write) -> Result<(), Failure> {
    let port = service.port;
    let mut server = Server::bind(port).map_err(|cause| {
        let message = format!("cannot listen on port {port}: {cause}; choose another `--port`");
        Failure::new(Exit::Io, message)
    })?;
    service
        .origins
        .iter()
        .for_each(|origin| server.allow(origin));
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stopped))?;
    }
    let mut first = None;
    for offer in offers {
        let link = print_links(&mut server, offer, out)?;
        first.get_or_insert(link);
    }
    writeln!(out, "Serving on {}; Ctrl-C ends it.", server.origin())?;
    out.flush()?;
    if let Some(link) = first.filter(|_| service.open) {
        browser::open(&link);
    }
    server.run(|| stopped.load(Ordering::Relaxed))?;
    // A terminal shows `^C`. The next output begins on its own line.
    if io::stdout().is_terminal() {
        writeln!(out)?;
    }
    Ok(())
}

/// Groups the recordings into offers, highlights first.
pub fn offers(files: &[PathBuf]) -> Result<Vec<Offer>, Failure> {
    let (mut compared, mut others) = (Vec::new(), Vec::new());
    for file in files {
        match comparison(file)? {
            Some(offer) => compared.push(offer),
            None => others.push(file.clone()),
        }
    }
    let groups = sorted(&others)?.into_iter();
    let offers = groups.map(|group| Offer {
        what: group.name(),
        layout: group.layout(),
        files: group.files,
    });
    Ok(offers.chain(compared).collect())
}

/// Returns the offer of a comparison of two runs; `None` for any other recording.
fn comparison(file: &Path) -> Result<Option<Offer>, Failure> {
    let recording = Recording::open(file)?;
    let layout = recording.attachment("foxglove-layout.json");
    let Some(layout) = layout.filter(|_| recording.extent() == Some(RecordingKind::Comparison))
    else {
        return Ok(None);
    };
    Ok(Some(Offer {
        what: "Two runs side by side".to_owned(),
        layout: String::from_utf8_lossy(layout).into_owned(),
        files: vec![file.to_owned()],
    }))
}

/// Recordings of one run with the same layout. Those of two runs would interleave in a viewer.
struct Group {
    plan: Plan,
    method: &'static str,
    kind: Kind,
    files: Vec<PathBuf>,
}

/// The kinds of recordings, in the order of the offers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Highlights,
    Run,
    Episodes,
}

impl Group {
    fn name(&self) -> String {
        let what = match self.kind {
            Kind::Highlights => "Highlights of the run",
            Kind::Run => "The whole run",
            Kind::Episodes => "Episodes",
        };
        let (world, seed) = (self.plan.maze.name(), self.plan.config.seed);
        format!("{what} in {world}: {}, seed {seed}", self.method)
    }

    fn layout(&self) -> String {
        match self.kind {
            Kind::Run => layout::of_run(&self.plan.maze),
            Kind::Highlights | Kind::Episodes => layout::of_episode(&self.plan.maze),
        }
    }
}

/// Groups the files by run and kind, highlights first.
fn sorted(files: &[PathBuf]) -> Result<Vec<Group>, Failure> {
    let mut groups: Vec<Group> = Vec::new();
    for file in files {
        let source = Source::of(file)?;
        let method = source.method_name();
        let plan = source.run.plan;
        let kind = match source.extent {
            RecordingKind::Highlights => Kind::Highlights,
            RecordingKind::Run => Kind::Run,
            // Comparisons are offered separately.
            RecordingKind::Episode(_) | RecordingKind::Comparison => Kind::Episodes,
        };
        let fits = |group: &&mut Group| group.plan == plan && group.kind == kind;
        match groups.iter_mut().find(fits) {
            Some(group) => group.files.push(file.clone()),
            None => groups.push(Group {
                plan,
                method,
                kind,
                files: vec![file.clone()],
            }),
        }
    }
    groups.sort_by_key(|group| group.kind);
    Ok(groups)
}

/// Prints the links of an offer and returns the first one.
fn print_links(server: &mut Server, offer: Offer, out: &mut impl Write) -> Result<String, Failure> {
    let layout = server.add("foxglove-layout.json", Content::Text(offer.layout));
    let mut links = Vec::new();
    for file in &offer.files {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        links.push(server.add(&name, Content::File(file.canonicalize()?)));
    }
    let what = offer.what;
    let linked = &links[links.len().saturating_sub(MOST_LINKED)..];
    match (links.len(), linked.len()) {
        (all, some) if some < all => writeln!(out, "{what} (the last {some} of {all})")?,
        _ => writeln!(out, "{what}")?,
    }
    let first = lichtblick_link(linked, &layout);
    write_link("Lichtblick  ", &first, out)?;
    write_link("Foxglove    ", &foxglove_link(linked), out)?;
    write_link("layout      ", &layout, out)?;
    Ok(first)
}
