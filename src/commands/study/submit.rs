//! `xcscr study submit`: submits the tasks of a study to a cluster.

use std::path::PathBuf;

use clap::ValueEnum;
use xcscr::study::{PlannedStudy, Queued, Slurm, StudyFolder, TaskState};

use super::choice::ChoiceArgs;
use crate::commands::failure::Failure;
use crate::commands::results::Results;

/// Arguments of `study submit`.
#[derive(Debug, clap::Args)]
pub struct SubmitArgs {
    #[command(flatten)]
    choice: ChoiceArgs,
    /// Workload manager of the cluster.
    #[arg(long, value_enum, default_value_t = Engine::Slurm)]
    engine: Engine,
    /// Number of tasks to split the study into, each one job; aim for 5 to 30 minutes of work each.
    /// Fixed by the first submission.
    #[arg(long, value_name = "N")]
    tasks: Option<usize>,
    /// Time limit of a task, such as 45m, 1h or 2d. A task that needs longer is interrupted and can
    /// be resumed.
    #[arg(long, value_name = "TIME", value_parser = minutes)]
    time: u64,
    /// Partition of the cluster.
    #[arg(long, value_name = "NAME", value_parser = partition)]
    partition: Option<String>,
    /// Processors of a task, each of which runs one trial at a time [default: 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    cpus: Option<u32>,
    /// Memory of a task, such as 500M or 2G [default: set by the cluster].
    #[arg(long, value_name = "SIZE", value_parser = megabytes)]
    mem: Option<u32>,
    /// Maximum number of tasks that run at the same time.
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    array_limit: Option<u32>,
    /// Folder of the study, on a file system that all machines of the cluster share.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print the scripts and commands without running them.
    #[arg(long)]
    dry_run: bool,
}

/// A workload manager.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Engine {
    /// Slurm: an array job, and a job that merges its results.
    Slurm,
}

/// Submits the tasks that are neither finished nor in the queue.
pub(super) fn run(args: &SubmitArgs, out: &mut Results) -> Result<(), Failure> {
    let Engine::Slurm = args.engine;
    let protocol = args.choice.protocol()?;
    super::say_warnings(&protocol);
    let planned = PlannedStudy::in_folder(&args.out, protocol, args.tasks)?;
    let slurm = Slurm {
        program: std::env::current_exe().map_err(Failure::system("find this program"))?,
        minutes: args.time,
        partition: args.partition.clone(),
        cpus: args.cpus,
        memory_mb: args.mem,
        array_limit: args.array_limit.map(|limit| limit as usize),
    };
    if args.dry_run {
        return show(&slurm, &planned, out);
    }
    // Fails before anything is frozen.
    Slurm::require()?;
    planned.make()?;
    let queue = match Slurm::knows(&planned) {
        true => Slurm::queue(&planned)?,
        false => vec![],
    };
    let tasks = open_tasks(&planned, &queue)?;
    if tasks.is_empty() {
        return Ok(writeln!(out, "{}", nothing_to_do(&planned, &queue))?);
    }
    let [array, merge] = slurm.submit(&planned, &tasks, &queue)?;
    let (count, folder) = (tasks.len(), xcscr::disk::typed(planned.path()));
    writeln!(
        out,
        "submitted {count} of {} tasks as job {array} (--array={}), and their merge as job {merge}",
        planned.tasks(),
        Slurm::ranges(&tasks)
    )?;
    Ok(writeln!(
        out,
        "show their progress: xcscr study status {folder}"
    )?)
}

/// Returns the tasks that are neither finished nor in the queue.
fn open_tasks(planned: &PlannedStudy, queue: &[Queued]) -> Result<Vec<usize>, Failure> {
    let states = StudyFolder::of(planned.clone(), None)?.task_states(queue)?;
    let open = states
        .into_iter()
        .filter(|(_, state)| matches!(state, TaskState::Failed | TaskState::Missing));
    Ok(open.map(|(task, _)| task).collect())
}

fn nothing_to_do(planned: &PlannedStudy, queue: &[Queued]) -> String {
    let folder = xcscr::disk::typed(planned.path());
    match queue.len() {
        0 => format!("all tasks are finished: merge them with `xcscr study merge {folder}`"),
        count => format!("nothing to submit: {count} tasks are in the queue, the others finished"),
    }
}

/// Prints the scripts and the commands that submit them.
fn show(slurm: &Slurm, planned: &PlannedStudy, out: &mut Results) -> Result<(), Failure> {
    let tasks = match PlannedStudy::is_in(planned.path()) {
        true => open_tasks(planned, &[])?,
        false => (1..=planned.tasks()).collect(),
    };
    if tasks.is_empty() {
        return Ok(writeln!(out, "{}", nothing_to_do(planned, &[]))?);
    }
    for (name, script) in slurm.scripts(planned, &tasks) {
        writeln!(out, "## {name}\n{script}")?;
    }
    Ok(write!(
        out,
        "## to submit them\n{}",
        Slurm::commands(planned)
    )?)
}

/// Parses a number with a unit. Returns it in the unit whose factor is 1; `None` for 0.
fn with_unit<const N: usize>(text: &str, units: [(&str, u32); N]) -> Option<u32> {
    let read = |(unit, factor): (&str, u32)| {
        let number: u32 = text.strip_suffix(unit)?.parse().ok()?;
        number.checked_mul(factor)
    };
    let number = units.into_iter().find_map(read);
    number.filter(|&number| number > 0)
}

/// Parses a duration to minutes, the unit of Slurm.
fn minutes(text: &str) -> Result<u64, String> {
    let minutes = with_unit(text, [("m", 1), ("h", 60), ("d", 24 * 60)]);
    let minutes = minutes.filter(|&minutes| minutes <= 365 * 24 * 60);
    let fault = "write minutes, hours or days, such as 45m, 1h or 2d; a year at most";
    minutes.map(u64::from).ok_or_else(|| fault.to_owned())
}

/// Parses a size to megabytes.
fn megabytes(text: &str) -> Result<u32, String> {
    let megabytes = with_unit(text, [("M", 1), ("G", 1024)]);
    megabytes.ok_or_else(|| "write megabytes or gigabytes, such as 500M or 2G".to_owned())
}

/// Parses a partition name that needs no quoting in a script.
fn partition(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.,".contains(c);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => Ok(text.to_owned()),
        false => Err("partitions have names of letters, digits, and - _ . ,".to_owned()),
    }
}
