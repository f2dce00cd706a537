//! `xcscr drive`: drives a robot with a learned policy.

use std::path::{Path, PathBuf};

use strum::VariantArray;
use xcscr::ErrorKind;
use xcscr::drive::DriveRecording;
use xcscr::drive::{
    DriveOptions, DriveSetup, Driver, DriverOptions, Fault, Frames, PoseSource, Wheels,
};
use xcscr::trial::{RobotProfile, ScanOrder};

use super::failure::Failure;
use super::node::{self, NodeArgs};
use super::results::Results;
use super::{choices, learned};

/// Arguments of `drive`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("what").required(true).args(["ros2", "bag"]))]
pub struct DriveArgs {
    /// The folder of a run, or one of its recordings.
    run: PathBuf,
    /// Drive a robot on ROS 2 (needs a build with `--features ros2`).
    #[arg(long)]
    ros2: bool,
    /// Decide from the sensor readings in an MCAP file, recorded by `drive` or `ros2 bag record`,
    /// and print the decisions. For a recorded drive, compare them with its decisions.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["sim_time", "stamped", "dry_run", "out", "force", "NodeArgs"])]
    bag: Option<PathBuf>,
    /// The robot: a bundled profile or a TOML file. It must be the robot that the policy was
    /// trained with.
    #[arg(long, value_name = "NAME|FILE")]
    robot: Option<String>,
    /// The maze, if it is not the run's own. Its cells must have the same size.
    #[arg(long, value_name = "FILE")]
    world: Option<PathBuf>,
    /// Start pose in the map frame: x and y in metres, heading in radians [default: the start
    /// cell].
    #[arg(long, value_name = "X,Y,YAW", value_parser = node::pose, allow_hyphen_values = true)]
    start: Option<[f64; 3]>,
    /// Deviation of the robot from the start pose: in metres, and in radians [default: 0.01,0.01].
    #[arg(long, value_name = "M,RAD", value_parser = node::numbers::<2>)]
    start_tolerance: Option<[f64; 2]>,
    /// Where the pose comes from: xcscr's own filter, or the transform from map to odom on /tf, such as
    /// that of AMCL.
    #[arg(long, value_name = "SOURCE", default_value = "own")]
    localise: Localise,
    /// Take the rotation of the wheels from /joint_states: the names of the left and the right joint,
    /// and the radius of the wheels in metres. For robots whose odometry has the heading of the IMU.
    #[arg(long, value_name = "LEFT,RIGHT,M", value_parser = node::wheels)]
    wheels: Option<Wheels>,
    /// Pose of the lidar on the robot: x and y in metres, heading in radians [default: from
    /// /tf_static].
    #[arg(long, value_name = "X,Y,YAW", value_parser = node::pose, allow_hyphen_values = true)]
    laser: Option<[f64; 3]>,
    /// With --laser, the frame of scans [default: base_scan, laser, laser_frame or base_link].
    #[arg(long, value_name = "NAME", requires = "laser")]
    scan_frame: Option<String>,
    /// Prefix of the names of all frames but map, such as tb3/.
    #[arg(long, value_name = "P", default_value = "")]
    frame_prefix: String,
    /// Order in which scans list their beams: forward, reversed with the time of the last beam (LDS),
    /// or of the first (RPLIDAR) [default: that of --robot, or else forward].
    #[arg(long, value_name = "ORDER", value_parser = choices::one_of(ScanOrder::VARIANTS, <&str>::from))]
    scan_order: Option<ScanOrder>,
    /// Take the time from /clock, for a simulated robot.
    #[arg(long)]
    sim_time: bool,
    /// Publish TwistStamped on cmd_vel instead of Twist.
    #[arg(long)]
    stamped: bool,
    /// Decide and record, but publish no command and no transform. Other nodes may drive the robot.
    #[arg(long)]
    dry_run: bool,
    /// The file for the recording [default: the name of the run with `-drive.mcap` appended].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace an earlier recording.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    node: NodeArgs,
}

/// Where the pose comes from.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Localise {
    Own,
    Tf,
}

impl DriveArgs {
    /// Returns where the pose comes from.
    fn source(&self) -> PoseSource {
        match self.localise {
            Localise::Own => PoseSource::Own,
            Localise::Tf => PoseSource::Tf,
        }
    }

    fn setup(&self) -> Result<DriveSetup, Failure> {
        let (plan, knowledge) = learned::of_run(&self.run, self.run.is_file())?;
        let mut frames = Frames::default().with_prefix(&self.frame_prefix);
        if let Some(scan) = &self.scan_frame {
            frames.scan = vec![scan.clone()];
        }
        let options = DriveOptions {
            robot: self.robot.as_deref().map(RobotProfile::load).transpose()?,
            world: self.world.as_deref().map(choices::world).transpose()?,
            start: self.start,
            laser: self.laser,
            frames,
            source: self.source(),
            start_tolerance: self.start_tolerance,
            wheels: self.wheels.clone(),
            scan_order: self.scan_order,
        };
        Ok(DriveSetup::new(&plan, &knowledge, options)?)
    }

    /// Returns the file for the recording.
    fn file(&self) -> PathBuf {
        let default = || learned::beside(&self.run, "-drive.mcap");
        self.out.clone().unwrap_or_else(default)
    }
}

/// Runs `xcscr drive`.
pub fn run(args: &DriveArgs, out: &mut Results) -> Result<(), Failure> {
    let setup = args.setup()?;
    if let Some(bag) = &args.bag {
        return repeat(Driver::new(setup), bag, out);
    }
    let options = DriverOptions {
        node: args.node.options()?,
        sim_time: args.sim_time,
        stamped: args.stamped,
        dry_run: args.dry_run,
        source: args.source(),
        reads_joints: args.wheels.is_some(),
    };
    drive(setup, &options, (&args.file(), args.force), out)
}

/// Decides from recorded readings, and compares the decisions.
fn repeat(driver: Driver, bag: &Path, out: &mut Results) -> Result<(), Failure> {
    let recording = DriveRecording::read(bag)?;
    let (own, final_fault) = decide(driver, &recording, out)?;
    let recorded = &recording.decisions;
    let refuted = |message: String| Err(Failure::new(ErrorKind::Refuted, message));
    if own.is_empty() && recorded.is_empty() {
        return refuted(format!("{} led to no decision", bag.display()));
    }
    if recorded.is_empty() {
        writeln!(out, "{} decisions", own.len())?;
    } else {
        let same = own.iter().zip(recorded).filter(|(a, b)| a == b).count();
        let most = own.len().max(recorded.len());
        writeln!(
            out,
            "{same} of {most} decisions are the same as in the recorded drive"
        )?;
        if same != most {
            return refuted("the decisions differ".to_owned());
        }
    }
    match final_fault {
        Some(fault) => refuted(fault.to_string()),
        None => Ok(()),
    }
}

/// Prints the decisions and the faults of a driver. Returns the decisions, and the fault that ended the drive.
fn decide(
    mut driver: Driver,
    recording: &DriveRecording,
    out: &mut Results,
) -> Result<(Vec<String>, Option<Fault>), Failure> {
    let (mut decisions, mut final_fault) = (Vec::new(), None);
    let mut reported: Vec<&str> = Vec::new();
    for (time_ns, readings) in &recording.readings {
        let step = driver.step(*time_ns, readings);
        let names: Vec<&str> = step.faults.iter().map(Fault::name).collect();
        if names != reported {
            reported = names;
            print_faults(&step.faults, out)?;
        }
        if let Some(decision) = step.decision {
            writeln!(out, "{:>3}  {}", decision.number, decision.words)?;
            decisions.push(decision.words);
        }
        final_fault = step.faults.into_iter().find(Fault::is_final);
    }
    Ok((decisions, final_fault))
}

fn print_faults(faults: &[Fault], out: &mut Results) -> Result<(), Failure> {
    match faults {
        [] => writeln!(out, "     no fault: continues")?,
        _ => {
            for fault in faults {
                writeln!(out, "     stops: {fault}")?;
            }
        }
    }
    Ok(out.flush()?)
}

/// Converts the end of a drive to the result of the command.
#[cfg(feature = "ros2")]
fn end(phase: xcscr::drive::Phase, faults: &[Fault], decisions: u32) -> Result<(), Failure> {
    use xcscr::drive::Phase;

    let lasting = faults.iter().find(|fault| fault.is_final());
    match (phase, lasting) {
        (_, Some(Fault::Interrupted)) => Err(Failure::new(
            ErrorKind::Interrupted,
            "interrupted; the robot is at rest",
        )),
        (_, Some(fault)) => Err(Failure::new(ErrorKind::Refuted, fault.to_string())),
        (Phase::AtGoal, None) => Ok(()),
        _ => {
            let message = format!("no goal after {decisions} decisions");
            Err(Failure::new(ErrorKind::Refuted, message))
        }
    }
}

#[cfg(feature = "ros2")]
fn drive(
    setup: DriveSetup,
    options: &DriverOptions,
    (file, replace): (&Path, bool),
    out: &mut Results,
) -> Result<(), Failure> {
    use std::time::{SystemTime, UNIX_EPOCH};

    use super::interrupt::Interrupt;
    use xcscr::drive::DriveBag;
    use xcscr::ros2::DriveReport;

    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let now_ns = since.map_or(0, |since| since.as_nanos() as u64);
    let bag = DriveBag::create(file, replace, setup.maze(), now_ns)?;
    let interrupt = Interrupt::notice()?;
    // A failure to print must not stop the robot between two cells, so errors are ignored.
    let mut report = |report: DriveReport<'_>| {
        let _ = match report {
            DriveReport::Faults(faults) => print_faults(faults, out),
            DriveReport::Step(step) => print_step(step, out),
        };
    };
    let driver = Driver::new(setup);
    let summary = xcscr::ros2::drive(
        driver,
        options,
        Some(bag),
        &|| interrupt.came(),
        &mut report,
    )?;
    let latency = summary.latency;
    writeln!(
        out,
        "{} decisions; latency from scan to command, {} scans: median {:.2} ms, p99 {:.2} ms, max {:.2} ms",
        summary.decisions, latency.count, latency.median_ms, latency.p99_ms, latency.most_ms
    )?;
    end(summary.phase, &summary.faults, summary.decisions)
}

#[cfg(feature = "ros2")]
fn print_step(step: &xcscr::drive::DriverStep, out: &mut Results) -> Result<(), Failure> {
    if let Some(decision) = &step.decision {
        writeln!(out, "{:>3}  {}", decision.number, decision.words)?;
    }
    if step.phase == xcscr::drive::Phase::AtGoal {
        writeln!(out, "     at the goal")?;
    }
    Ok(out.flush()?)
}

#[cfg(not(feature = "ros2"))]
fn drive(
    _: DriveSetup,
    _: &DriverOptions,
    _: (&Path, bool),
    _: &mut Results,
) -> Result<(), Failure> {
    Err(node::missing())
}
