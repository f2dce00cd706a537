//! Slurm: an array job that runs the tasks, and a job that merges them.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::disk;
use crate::error::{Error, ErrorKind};
use crate::study::error;
use crate::study::protocol::id_of;
use crate::study::store::PlannedStudy;

/// The folder of scripts and logs, relative to the folder of the study.
const FOLDER: &str = "slurm";
const ARRAY: &str = "slurm/array.sh";
const MERGE: &str = "slurm/merge.sh";
/// The start of the last line of a script.
const CHECKSUM: &str = "# Written by xcscr. Checksum of the lines above: ";
/// Maximum size of a script, which is more than a list of 100,000 tasks needs.
const MOST_SCRIPT_BYTES: u64 = 1 << 21;
/// Time between the signal and the time limit: the longest shutdown of the program, plus a reserve
/// for a slow file system. Slurm may send the signal a minute earlier.
const SHUTDOWN_SECS: u64 = 30;

/// Slurm settings for the tasks of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slurm {
    /// The path of this program on the machines of the cluster.
    pub program: PathBuf,
    /// The time limit of a task, in minutes.
    pub minutes: u64,
    /// The partition. The cluster's default if `None`.
    pub partition: Option<String>,
    /// Processors per task; each runs one trial at a time. One if `None`.
    pub cpus: Option<u32>,
    /// The memory of a task in megabytes. The cluster's default if `None`.
    pub memory_mb: Option<u32>,
    /// Maximum number of tasks that run at a time. The cluster's limit if `None`.
    pub array_limit: Option<usize>,
}

/// A task in Slurm's queue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Queued {
    /// The task, counted from 1.
    pub task: usize,
    /// The number of the array job.
    pub job: String,
    /// Whether the task is running.
    pub running: bool,
}

impl Slurm {
    /// Returns true if this study was ever submitted to Slurm.
    pub fn knows(planned: &PlannedStudy) -> bool {
        planned.path().join(FOLDER).is_dir()
    }

    /// Checks that Slurm's commands are installed.
    ///
    /// # Errors
    /// When they are not.
    pub fn require() -> Result<(), Error> {
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let mut folders = std::env::split_paths(&folders);
        match folders.any(|folder| folder.join("sbatch").is_file()) {
            true => Ok(()),
            false => Err(no_slurm("sbatch")),
        }
    }

    /// Returns the tasks of a study that are in the queue.
    ///
    /// # Errors
    /// When the queue cannot be read.
    pub fn queue(planned: &PlannedStudy) -> Result<Vec<Queued>, Error> {
        let mut command = Command::new("squeue");
        let name = format!("--name={}", name(planned));
        command.args(["--noheader", "--array", &name, "--format=%F %K %T %Z"]);
        let here = absolute(planned.path())?;
        let listed = answer(command)?;
        let entry = |line: &str| {
            let mut words = line.splitn(4, ' ');
            let (job, task) = (words.next()?, words.next()?.parse().ok()?);
            let running = words.next()? != "PENDING";
            let is_here = Path::new(words.next()?.trim_end()) == here;
            let job = job.to_owned();
            is_here.then_some(Queued { task, job, running })
        };
        Ok(listed.lines().filter_map(entry).collect())
    }

    /// Returns the names and texts of the scripts that run these tasks, and merge all results.
    pub fn scripts(&self, planned: &PlannedStudy, tasks: &[usize]) -> [(&'static str, String); 2] {
        [
            (ARRAY, signed(self.array_script(planned, tasks))),
            (MERGE, signed(self.merge_script(planned))),
        ]
    }

    /// Writes the scripts for these tasks and submits them. The merge starts when all of these
    /// tasks, and those in the queue, are finished. Returns the numbers of the array job and of the
    /// merge job.
    ///
    /// # Errors
    /// When a script was changed by hand, Slurm refuses, or a file cannot be written.
    pub fn submit(
        &self,
        planned: &PlannedStudy,
        tasks: &[usize],
        queue: &[Queued],
    ) -> Result<[String; 2], Error> {
        let scripts = self.scripts(planned, tasks);
        let scripts = scripts.map(|(name, text)| (planned.path().join(name), text));
        require_folder(&planned.path().join(FOLDER))?;
        scripts.iter().try_for_each(|(path, _)| require_own(path))?;
        let logs = planned.path().join(FOLDER).join("logs");
        fs::create_dir_all(&logs).map_err(disk::cannot_create(&logs))?;
        for (path, text) in scripts {
            disk::replace(&path, text.as_bytes()).map_err(error::io(&path))?;
        }
        let array = sbatch(planned, ARRAY, &[])?;
        let after = dependency(&array, queue);
        let merge = sbatch(
            planned,
            MERGE,
            &[after, "--kill-on-invalid-dep=yes".to_owned()],
        )?;
        Ok([array, merge])
    }

    fn array_script(&self, planned: &PlannedStudy, tasks: &[usize]) -> String {
        let limit = self.array_limit.map(|limit| format!("%{limit}"));
        let array = Slurm::ranges(tasks) + &limit.unwrap_or_default();
        let lead = SHUTDOWN_SECS.min(60 * self.minutes / 2);
        let mut own = vec![
            format!("--array={array}"),
            format!("--signal=B:USR1@{lead}"),
            "--requeue".to_owned(),
        ];
        own.extend(self.cpus.map(|cpus| format!("--cpus-per-task={cpus}")));
        let head = self.head(&name(planned), "%a", &own);
        let script = include_str!("array.sh");
        let script = script.replace("@TASKS@", &planned.tasks().to_string());
        let script = script.replace("@PROGRAM@", &disk::typed(&self.program));
        format!("{head}\n{script}")
    }

    fn merge_script(&self, planned: &PlannedStudy) -> String {
        let head = self.head(&format!("{}-merge", name(planned)), "merge", &[]);
        let program = disk::typed(&self.program);
        format!("{head}\nexec {program} study merge .\n")
    }

    /// Returns the shebang line and the `#SBATCH` lines.
    fn head(&self, name: &str, log: &str, own: &[String]) -> String {
        let days = self.minutes / (24 * 60);
        let (hours, minutes) = (self.minutes / 60 % 24, self.minutes % 60);
        let mut lines = vec![
            format!("--job-name={name}"),
            format!("--time={days}-{hours:02}:{minutes:02}:00"),
            format!("--output={FOLDER}/logs/{log}.log"),
            "--open-mode=append".to_owned(),
        ];
        let partition = self.partition.iter();
        lines.extend(partition.map(|partition| format!("--partition={partition}")));
        lines.extend(
            self.memory_mb
                .map(|memory_mb| format!("--mem={memory_mb}M")),
        );
        lines.extend_from_slice(own);
        let mut head = "#!/usr/bin/env bash\n".to_owned();
        for line in lines {
            let _ = writeln!(head, "#SBATCH {line}");
        }
        head
    }
}

impl Slurm {
    /// Returns the shell commands that submit the scripts by hand.
    pub fn commands(planned: &PlannedStudy) -> String {
        let folder = disk::typed(planned.path());
        format!(
            "cd {folder} && mkdir -p {FOLDER}/logs\n\
             array=$(sbatch --parsable {ARRAY})\n\
             sbatch --dependency=afterok:\"$array\" --kill-on-invalid-dep=yes {MERGE}\n"
        )
    }
}

/// Appends a checksum to a script, to detect changes by hand.
fn signed(script: String) -> String {
    let checksum = id_of(&script);
    format!("{script}{CHECKSUM}{checksum}\n")
}

/// Refuses to replace a script that was changed by hand, or was not made by this program.
fn require_own(path: &Path) -> Result<(), Error> {
    let text = match disk::read_text(path, MOST_SCRIPT_BYTES) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(()),
        // The file is too large for a generated script, or is not text.
        Err(_) => String::new(),
        Ok(text) => text,
    };
    let script = text.rsplit_once(CHECKSUM).map(|(script, _)| script);
    match script.is_some_and(|script| signed(script.to_owned()) == text) {
        true => Ok(()),
        false => Err(error::altered(path)),
    }
}

/// Refuses a symbolic link, which may point outside of the study's folder.
fn require_folder(path: &Path) -> Result<(), Error> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => {
            let cause = io::Error::other("it is a symbolic link; replace it with a folder");
            Err(disk::cannot_create(path)(cause))
        }
        _ => Ok(()),
    }
}

/// Returns the job name. The jobs of a study are identified in the queue by name and folder.
fn name(planned: &PlannedStudy) -> String {
    format!("xcscr-{}", planned.plan())
}

/// The merge starts after these tasks succeed, and after the queued jobs end, successful or not.
fn dependency(array: &str, queue: &[Queued]) -> String {
    let mut jobs: Vec<&str> = queue.iter().map(|waiting| waiting.job.as_str()).collect();
    jobs.sort_unstable();
    jobs.dedup();
    let others: String = jobs.iter().map(|job| format!(",afterany:{job}")).collect();
    format!("--dependency=afterok:{array}{others}")
}

/// Submits a script in the folder of the study, and returns the number of its job.
fn sbatch(planned: &PlannedStudy, script: &str, options: &[String]) -> Result<String, Error> {
    let mut command = Command::new("sbatch");
    command.current_dir(planned.path()).arg("--parsable");
    command.args(options).arg(script);
    let answer = answer(command)?;
    // In a multi-cluster setup, the name of the cluster follows the number.
    let number = answer.trim().split(';').next().unwrap_or_default();
    Ok(number.to_owned())
}

fn no_slurm(command: &str) -> Error {
    ErrorKind::Io.error(format!(
        "{command}: Slurm is not installed here; run this on a login node of the cluster, or print the \
         scripts with `study submit --dry-run`"
    ))
}

/// Runs a command, and returns its standard output.
fn answer(mut command: Command) -> Result<String, Error> {
    let name = command.get_program().to_string_lossy().into_owned();
    let fault = |fault: &str| ErrorKind::Io.error(format!("{name}: {fault}"));
    let output = command.output().map_err(|cause| match cause.kind() {
        io::ErrorKind::NotFound => no_slurm(&name),
        _ => fault(&cause.to_string()),
    })?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(fault(String::from_utf8_lossy(&output.stderr).trim())),
    }
}

/// Returns a path in the form in which Slurm lists it.
fn absolute(path: &Path) -> Result<PathBuf, Error> {
    path.canonicalize().map_err(error::io(path))
}

impl Slurm {
    /// Formats ascending numbers as the list of an array job, such as `1-3,7`.
    pub fn ranges(numbers: &[usize]) -> String {
        let runs = numbers.chunk_by(|a, b| a + 1 == *b);
        let run = |run: &[usize]| match run {
            [first, .., last] => format!("{first}-{last}"),
            _ => run.iter().map(usize::to_string).collect(),
        };
        runs.map(run).collect::<Vec<_>>().join(",")
    }
}
