//! Full disks, file-size limits, and disks that may only be read: a message with file and way out, and nothing
//! whole is harmed.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::signals::{LONG_RUN, end_of, signalled};
use crate::kit::desk::Desk;
use crate::kit::folder::{assert_same, contents};
use crate::kit::program::{ended, output_of, signal, wait_for};
use xcscr::record;

/// Every file that has its final name is whole: recordings are sound, and documents can be read.
#[track_caller]
fn assert_whole(folder: &Path) {
    for (name, bytes) in contents(folder) {
        if name.ends_with(".mcap") {
            let findings = record::check(&folder.join(&name)).unwrap();
            assert!(findings.is_empty(), "{name}: {findings:?}");
        } else if name.ends_with(".json") {
            serde_json::from_slice::<serde_json::Value>(&bytes).expect(&name);
        }
    }
}

#[test]
fn a_file_size_limit_ends_in_code_74_and_the_run_goes_on_when_it_is_lifted() {
    let desk = Desk::new();
    let line = "train maze4 --episodes 120 --quiet --out @run";
    let limited = desk.limited("-f 150", line).output().unwrap();
    let (_, stderr) = ended(&limited, 74, "ulimit -f");
    assert!(
        stderr.contains(".mcap.part") && stderr.contains("--resume"),
        "{stderr}"
    );
    let run = desk.path("run");
    assert_whole(&run);
    desk.ok("train --resume @run");
    let wanted = desk.train("wanted", "maze4 --episodes 120");
    assert_same(&run, &wanted, "after the limit was lifted");
}

/// A file system of its own with a few megabytes, while this lives.
struct SmallDisk(Desk);

impl SmallDisk {
    fn mount(size: &str) -> Option<Self> {
        let desk = Desk::new();
        let options = format!("size={size}");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &options, "xcscr-test"])
            .arg(desk.folder())
            .output();
        if mounted.is_ok_and(|output| output.status.success()) {
            return Some(Self(desk));
        }
        println!("skipped: only root may mount a small disk, and not everywhere");
        None
    }

    /// Changes its options, such as `ro` or `size=60m`.
    fn remount(&self, options: &str) {
        let options = format!("remount,{options}");
        let mut command = Command::new("mount");
        let done = command.args(["-o", &options]).arg(self.0.folder()).status();
        assert!(done.unwrap().success(), "{options}");
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.folder()).output();
    }
}

#[cfg(feature = "long")]
#[test]
fn pictures_pages_and_studies_on_a_full_disk_end_in_code_74_and_leave_nothing_torn() {
    let Some(disk) = SmallDisk::mount("64k") else {
        return;
    };
    let (desk, elsewhere) = (&disk.0, Desk::new());
    let run = elsewhere.train("run", "maze4 --episodes 9");
    let run = run.to_str().unwrap();
    desk.write("ballast", vec![0; 48 * 1024]);
    for line in [
        &format!("map {run} --worth -o @p.svg")[..],
        &format!("replay {run} --html @page.html"),
        "study run paper --episodes 1 --out @s",
    ] {
        desk.fails(74, line, "No space left");
    }
    let entries = fs::read_dir(desk.folder()).unwrap().map(Result::unwrap);
    let files = entries.filter(|entry| entry.path().is_file());
    let names: Vec<_> = files.map(|entry| entry.file_name()).collect();
    assert_eq!(names, ["ballast"]);
}

#[cfg(feature = "long")]
#[test]
fn a_disk_that_may_only_be_read_ends_in_code_73_and_is_left_as_it_is() {
    let Some(disk) = SmallDisk::mount("60m") else {
        return;
    };
    let desk = &disk.0;
    let child = desk.spawn(LONG_RUN);
    wait_for(&desk.path("run/ep-0005.mcap"));
    signal(&child, "KILL");
    output_of(child);
    let before = contents(&desk.path("run"));
    disk.remount("ro");
    for line in [
        "train --resume @run",
        "train maze4 --force --out @run",
        "train maze4 --out @new",
    ] {
        desk.fails(73, line, "Read-only");
    }
    assert!(
        contents(&desk.path("run")) == before,
        "something was written"
    );
    disk.remount("rw");
    let again = signalled(desk, "train --resume @run", &["TERM"]);
    end_of(again, 75, "when it may be written again");
}
