//! Slurm: an array job of the tasks, and a job that merges them.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::Command;

use super::planned::PlannedStudy;
use super::survey::Survey;
use crate::disk;
use crate::study::error::StudyError;
use crate::study::protocol::id_of;
use crate::study::store::files::write_whole;

/// Scripts and logs, below the folder of the study.
const FOLDER: &str = "slurm";
const ARRAY: &str = "slurm/array.sh";
const MERGE: &str = "slurm/merge.sh";
/// Begins the last line of a script.
const CHECKSUM: &str = "# Written by xcscr. Checksum of the lines above: ";
/// More than the list of 100,000 tasks takes.
const MOST_SCRIPT_BYTES: u64 = 1 << 21;
/// How long before the time limit a signal is wanted: what the program needs at most, and some room for
/// a slow file system. Slurm may send it a minute earlier.
const FAREWELL_SECS: u64 = 30;

/// How the tasks of a study are to be run by Slurm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slurm {
    /// This program, as the machines of the cluster find it.
    pub program: PathBuf,
    /// The time limit of a task, in minutes.
    pub minutes: u64,
    /// The partition; the cluster's own choice if `None`.
    pub partition: Option<String>,
    /// Processors of a task, each of which runs a trial at a time; one if `None`.
    pub cpus: Option<u32>,
    /// The memory of a task in megabytes; the cluster's own choice if `None`.
    pub memory_mb: Option<u32>,
    /// Tasks at a time; as many as the cluster likes if `None`.
    pub array_limit: Option<usize>,
}

/// What became of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskState {
    /// All its trials are finished.
    Complete,
    /// It is running now.
    Running,
    /// It waits for its turn.
    Waiting,
    /// It was begun, and ended before its last trial.
    Failed,
    /// It was never begun.
    Missing,
}

/// A task that Slurm has in its queue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Queued {
    /// The task, counted from 1.
    pub task: usize,
    /// The number of the array job.
    pub job: String,
    /// Is it running?
    pub running: bool,
}

impl Slurm {
    /// Was this study ever given to Slurm?
    pub fn knows(planned: &PlannedStudy) -> bool {
        planned.path().join(FOLDER).is_dir()
    }

    /// Requires that Slurm's commands are here.
    ///
    /// # Errors
    /// [`StudyError::Engine`] when they are not.
    pub fn require() -> Result<(), StudyError> {
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let mut folders = std::env::split_paths(&folders);
        match folders.any(|folder| folder.join("sbatch").is_file()) {
            true => Ok(()),
            false => Err(no_slurm("sbatch")),
        }
    }

    /// The tasks of a study that are in the queue.
    ///
    /// # Errors
    /// [`StudyError::Engine`] when the queue cannot be seen.
    pub fn queue(planned: &PlannedStudy) -> Result<Vec<Queued>, StudyError> {
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

    /// The scripts that run these tasks, and merge all: their names and texts.
    pub fn scripts(&self, planned: &PlannedStudy, tasks: &[usize]) -> [(&'static str, String); 2] {
        [
            (ARRAY, signed(self.array_script(planned, tasks))),
            (MERGE, signed(self.merge_script(planned))),
        ]
    }

    /// Writes the scripts for these tasks and submits them; the merge begins when all of them, and
    /// those that are in the queue, are done. Gives the numbers of the array job and of the merge.
    ///
    /// # Errors
    /// [`StudyError::Altered`] when a script was changed by hand, [`StudyError::Engine`], or an error
    /// of the file system.
    pub fn submit(
        &self,
        planned: &PlannedStudy,
        tasks: &[usize],
        queue: &[Queued],
    ) -> Result<[String; 2], StudyError> {
        let scripts = self.scripts(planned, tasks);
        let scripts = scripts.map(|(name, text)| (planned.path().join(name), text));
        require_folder(&planned.path().join(FOLDER))?;
        scripts.iter().try_for_each(|(path, _)| require_own(path))?;
        let logs = planned.path().join(FOLDER).join("logs");
        fs::create_dir_all(&logs).map_err(|cause| StudyError::create(&logs, cause))?;
        for (path, text) in scripts {
            write_whole(&path, text.as_bytes())?;
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
        let lead = FAREWELL_SECS.min(60 * self.minutes / 2);
        let mut own = vec![
            format!("--array={array}"),
            format!("--signal=B:USR1@{lead}"),
            "--requeue".to_owned(),
        ];
        own.extend(self.cpus.map(|cpus| format!("--cpus-per-task={cpus}")));
        let head = self.head(&name(planned), "%a", &own);
        let (program, count) = (disk::typed(&self.program), planned.tasks());
        format!(
            r#"{head}
# A task of the {count} that this study is split into. Before the time limit, and when the machine is
# needed, a signal comes: the program keeps what it finished, ends with code 75, and the task goes back
# into the queue, unless somebody cancelled it.
{program} study task . "$SLURM_ARRAY_TASK_ID" --jobs "${{SLURM_CPUS_PER_TASK:-1}}" --quiet &
task=$!
trap 'stopped=yes; kill -TERM "$task"' USR1 TERM
wait "$task"
code=$?
if [ -n "${{stopped:-}}" ]; then
    wait "$task"
    code=$?
fi
if [ "$code" -eq 75 ]; then
    me="${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}"
    if [ "$(squeue --noheader --jobs="$me" --states=RUNNING --format=%T)" = RUNNING ]; then
        scontrol requeue "$me"
    fi
fi
exit "$code"
"#
        )
    }

    fn merge_script(&self, planned: &PlannedStudy) -> String {
        let head = self.head(&format!("{}-merge", name(planned)), "merge", &[]);
        let program = disk::typed(&self.program);
        format!("{head}\nexec {program} study merge .\n")
    }

    /// The lines that Slurm reads.
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
    /// How the scripts are submitted by hand.
    pub fn commands(planned: &PlannedStudy) -> String {
        let folder = disk::typed(planned.path());
        format!(
            "cd {folder} && mkdir -p {FOLDER}/logs\n\
             array=$(sbatch --parsable {ARRAY})\n\
             sbatch --dependency=afterok:\"$array\" --kill-on-invalid-dep=yes {MERGE}\n"
        )
    }
}

impl Survey {
    /// What became of each task, given what is in the queue.
    pub fn states(&self, queue: &[Queued]) -> Vec<(usize, TaskState)> {
        let state = |one: &super::TaskSurvey| {
            let queued = queue.iter().find(|waiting| waiting.task == one.task);
            match (one.missing, queued, one.attempts) {
                (0, _, _) => TaskState::Complete,
                (_, Some(Queued { running: true, .. }), _) => TaskState::Running,
                (_, Some(_), _) => TaskState::Waiting,
                (_, None, 0) => TaskState::Missing,
                (_, None, _) => TaskState::Failed,
            }
        };
        self.tasks()
            .iter()
            .map(|one| (one.task, state(one)))
            .collect()
    }
}

/// A script with its checksum, by which it is known that nobody changed it.
fn signed(script: String) -> String {
    let checksum = id_of(&script);
    format!("{script}{CHECKSUM}{checksum}\n")
}

/// Refuses to replace a script that was changed by hand, or was not made by this program.
fn require_own(path: &Path) -> Result<(), StudyError> {
    let text = match disk::read_text(path, MOST_SCRIPT_BYTES) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(()),
        // It is too large for a script of ours, or no text.
        Err(_) => String::new(),
        Ok(text) => text,
    };
    let script = text.rsplit_once(CHECKSUM).map(|(script, _)| script);
    match script.is_some_and(|script| signed(script.to_owned()) == text) {
        true => Ok(()),
        false => Err(StudyError::Altered(path.to_owned())),
    }
}

/// Refuses a link that leads out of the folder of the study.
fn require_folder(path: &Path) -> Result<(), StudyError> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => {
            let cause = io::Error::other("it is a symbolic link; replace it with a folder");
            Err(StudyError::create(path, cause))
        }
        _ => Ok(()),
    }
}

/// The jobs of a study are found in the queue by their name, and by their folder.
fn name(planned: &PlannedStudy) -> String {
    format!("xcscr-{}", planned.plan())
}

/// The merge comes after these tasks if they succeed, and after those in the queue anyway.
fn dependency(array: &str, queue: &[Queued]) -> String {
    let mut jobs: Vec<&str> = queue.iter().map(|waiting| waiting.job.as_str()).collect();
    jobs.sort_unstable();
    jobs.dedup();
    let others: String = jobs.iter().map(|job| format!(",afterany:{job}")).collect();
    format!("--dependency=afterok:{array}{others}")
}

/// Submits a script in the folder of the study, and gives the number of its job.
fn sbatch(planned: &PlannedStudy, script: &str, options: &[String]) -> Result<String, StudyError> {
    let mut command = Command::new("sbatch");
    command.current_dir(planned.path()).arg("--parsable");
    command.args(options).arg(script);
    let answer = answer(command)?;
    // On a cluster of clusters, the name of the cluster comes behind the number.
    let number = answer.trim().split(';').next().unwrap_or_default();
    Ok(number.to_owned())
}

fn no_slurm(command: &str) -> StudyError {
    StudyError::Engine {
        command: command.to_owned(),
        fault:
            "there is no Slurm here; run this on a login node of the cluster, or see the scripts \
                with `study submit --dry-run`"
                .to_owned(),
    }
}

/// What a command says when it succeeds.
fn answer(mut command: Command) -> Result<String, StudyError> {
    let name = command.get_program().to_string_lossy().into_owned();
    let fault = |fault: String| StudyError::Engine {
        command: name.clone(),
        fault,
    };
    let output = command.output().map_err(|cause| match cause.kind() {
        ErrorKind::NotFound => no_slurm(&name),
        _ => fault(cause.to_string()),
    })?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(fault(
            String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        )),
    }
}

/// A path as Slurm names it.
fn absolute(path: &Path) -> Result<PathBuf, StudyError> {
    path.canonicalize()
        .map_err(|cause| StudyError::io(path, cause))
}

impl Slurm {
    /// Ascending numbers as the list of an array job, such as `1-3,7`.
    pub fn ranges(numbers: &[usize]) -> String {
        let runs = numbers.chunk_by(|a, b| a + 1 == *b);
        let run = |run: &[usize]| match run {
            [first, .., last] => format!("{first}-{last}"),
            _ => run.iter().map(usize::to_string).collect(),
        };
        runs.map(run).collect::<Vec<_>>().join(",")
    }
}
