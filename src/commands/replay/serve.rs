//! `xcscr replay`: prints links that open recordings in a viewer.

use std::collections::BTreeMap;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::record::RecordingKind;
use xcscr::record::layout;
use xcscr::record::reader::Recording;
use xcscr::replay::server::{Content, Origin, Server, viewer_links};
use xcscr::run::RecordedRun;
use xcscr::trial::Plan;

use super::page::is_episode;
use crate::commands::failure::Failure;
use crate::commands::interrupt::Interrupt;
use crate::commands::results::Results;
use crate::commands::terminal::write_link;

/// The most files that a link opens. The others can be dragged into the viewer.
const MOST_LINKED: usize = 10;

/// The options of the server.
pub struct Service<'a> {
    /// The port; 0 for any that is free.
    pub port: u16,
    /// Origins whose pages may read the recordings, in addition to those of the two viewers.
    pub origins: &'a [Origin],
}

/// Recordings that one link opens together.
pub struct Offer {
    /// A description of the recordings.
    pub what: String,
    /// The layout for the recordings.
    pub layout: String,
    /// The recordings.
    pub files: Vec<PathBuf>,
    /// The number of earlier recordings that no link opens.
    pub left_out: usize,
}

/// Serves until Ctrl-C.
pub fn run(offers: Vec<Offer>, service: &Service<'_>, out: &mut Results) -> Result<(), Failure> {
    let port = service.port;
    let mut server = Server::bind(port).map_err(|cause| {
        let message = format!("cannot listen on port {port}: {cause}; choose another `--port`");
        Failure::new(ErrorKind::Io, message)
    })?;
    service
        .origins
        .iter()
        .for_each(|origin| server.allow(origin));
    let interrupt = Interrupt::notice()?;
    for offer in offers {
        print_links(&mut server, offer, out)?;
    }
    writeln!(out, "Serving on {}; Ctrl-C ends it.", server.origin())?;
    out.flush()?;
    let served = server.run(|| interrupt.came());
    served.map_err(Failure::system("serve the recordings"))?;
    // A terminal shows `^C`. The next output begins on its own line.
    if io::stdout().is_terminal() {
        writeln!(out)?;
    }
    Ok(())
}

/// Groups the recordings by run and kind, the whole run first. Recordings of two
/// runs would interleave in a viewer. Of the episodes in a folder, only the last ones are read,
/// because links open no others.
pub fn offers(files: &[PathBuf]) -> Result<Vec<Offer>, Failure> {
    let mut groups: Vec<(Kind, Plan, Offer)> = Vec::new();
    let (last, mut left_out) = last_episodes(files);
    for file in last {
        let (kind, plan, mut offer) = group(file)?;
        if is_episode(file) {
            offer.left_out = left_out.remove(&file.parent()).unwrap_or(0);
        }
        let mut known = groups.iter_mut();
        match known.find(|group| (group.0, &group.1) == (kind, &plan)) {
            Some((.., known)) => {
                known.files.extend(offer.files);
                known.left_out += offer.left_out;
            }
            None => groups.push((kind, plan, offer)),
        }
    }
    groups.sort_by_key(|(kind, ..)| *kind);
    Ok(groups.into_iter().map(|(.., offer)| offer).collect())
}

/// Returns the files without all but the last episodes of each folder, and the number of those left
/// out by folder.
fn last_episodes(files: &[PathBuf]) -> (Vec<&PathBuf>, BTreeMap<Option<&Path>, usize>) {
    let (mut last, mut left_out) = (Vec::new(), BTreeMap::new());
    let mut counts: BTreeMap<Option<&Path>, usize> = BTreeMap::new();
    for file in files.iter().rev() {
        let count = counts.entry(file.parent()).or_default();
        *count += usize::from(is_episode(file));
        if is_episode(file) && *count > MOST_LINKED {
            *left_out.entry(file.parent()).or_default() += 1;
        } else {
            last.push(file);
        }
    }
    last.reverse();
    (last, left_out)
}

/// The kinds of recordings, in the order of the offers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Run,
    Episodes,
}

/// Returns the offer of one file, with its kind and the plan of its run.
fn group(file: &Path) -> Result<(Kind, Plan, Offer), Failure> {
    let files = vec![file.to_owned()];
    let recording = Recording::open(file)?;
    let source = RecordedRun::of_recording(&recording)?;
    let (kind, what) = match source.extent {
        RecordingKind::Run => (Kind::Run, "The whole run"),
        RecordingKind::Episode(_) => (Kind::Episodes, "Episodes"),
    };
    let (method, maze) = (source.method_name(), &source.run.plan.maze);
    let (world, seed) = (maze.name(), source.run.plan.config.seed);
    let offer = Offer {
        what: format!("{what} in {world}: {method}, seed {seed}"),
        layout: match kind {
            Kind::Run => layout::of_run(maze),
            _ => layout::of_episode(maze),
        },
        files,
        left_out: 0,
    };
    Ok((kind, source.run.plan, offer))
}

/// Prints the links of an offer.
fn print_links(server: &mut Server, offer: Offer, out: &mut Results) -> Result<(), Failure> {
    let layout = server.add("foxglove-layout.json", Content::Text(offer.layout));
    let linked = &offer.files[offer.files.len().saturating_sub(MOST_LINKED)..];
    let mut links = Vec::new();
    for file in linked {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let whole = file
            .canonicalize()
            .map_err(Failure::system("find a recording"))?;
        links.push(server.add(&name, Content::File(whole)));
    }
    let what = offer.what;
    match (offer.files.len() + offer.left_out, links.len()) {
        (all, some) if some < all => writeln!(out, "{what} (the last {some} of {all})")?,
        _ => writeln!(out, "{what}")?,
    }
    let links = viewer_links(&links, &layout);
    for (viewer, link) in &links {
        write_link(&format!("{viewer:<12}"), link, out)?;
    }
    Ok(write_link("layout      ", &layout, out)?)
}
