//! `xcscr man`: writes manual pages.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::disk;

use super::failure::Failure;

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// Folder of the pages, such as ~/.local/share/man/man1.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace pages with different content, such as those of another version.
    #[arg(long)]
    force: bool,
}

/// Writes a page for `program` and one for each of its commands.
pub fn run(args: &ManArgs, program: clap::Command) -> Result<(), Failure> {
    write_pages(args, program).map_err(|cause| {
        let (folder, way_out) = (args.out.display(), disk::way_out(&cause));
        let message = format!("cannot write manual pages into {folder}: {cause}{way_out}");
        Failure::new(ErrorKind::CannotCreate, message)
    })
}

fn write_pages(args: &ManArgs, program: clap::Command) -> io::Result<()> {
    // Into a temporary folder first: the library overwrites existing files.
    let made = tempfile::tempdir()?;
    clap_mangen::generate_to(program, made.path())?;
    fs::create_dir_all(&args.out)?;
    let pages: Vec<fs::DirEntry> = made.path().read_dir()?.collect::<io::Result<_>>()?;
    let pages = pages.iter().map(|page| {
        let file = args.out.join(page.file_name());
        Ok((file, fs::read(page.path())?))
    });
    let pages: Vec<(PathBuf, Vec<u8>)> = pages.collect::<io::Result<_>>()?;
    for (file, page) in &pages {
        if !args.force && disk::differs(file, page)? {
            return Err(taken(file));
        }
    }
    pages
        .iter()
        .try_for_each(|(file, page)| disk::write(file, page, true))
}

fn taken(file: &Path) -> io::Error {
    let file = file.display();
    let message =
        format!("{file} exists and holds something different (replace it with `--force`)");
    io::Error::new(io::ErrorKind::AlreadyExists, message)
}
