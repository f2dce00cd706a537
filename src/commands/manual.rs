//! `xcscr man`: manual pages.

use std::fs;
use std::path::{Path, PathBuf};

use super::failure::{Exit, Failure};

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// The folder of the pages, such as ~/.local/share/man/man1.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Writes a page for `program` and one for each of its commands.
pub fn run(args: &ManArgs, program: clap::Command) -> Result<(), Failure> {
    write_pages(&args.out, program).map_err(|cause| {
        let folder = args.out.display();
        let message = format!("cannot write manual pages into {folder}: {cause}");
        Failure::new(Exit::CannotCreate, message)
    })
}

fn write_pages(folder: &Path, program: clap::Command) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    clap_mangen::generate_to(program, folder)
}
