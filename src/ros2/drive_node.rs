//! The driver as a ROS 2 node.

use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use ros2_client::{Publisher, Subscription};
use serde::de::DeserializeOwned;

use super::diagnostics::{DiagnosticArray, Diagnostics};
use super::latency::Latency;
use super::link::{Link, STAMPED, TWIST, best_effort, drain, latched, reliable};
use super::velocity::Velocity;
use crate::Error;
use crate::arena::Speeds;
use crate::drive::DriveBag;
use crate::drive::drive_messages::{Clock, Imu, JointState, Text};
use crate::drive::messages::{EstimatedPose, LaserScan, MAP, ODOM, Odometry, Transforms};
use crate::drive::{
    Driver, DriverOptions, DriverStep, Fault, Network, Phase, PoseSource, Readings, Transform,
};

/// The control period: the longest time between two calls of the driver.
const PERIOD: Duration = Duration::from_millis(50);
/// The poll interval for messages.
const TICK: Duration = Duration::from_millis(1);
/// The poll interval for the ROS graph.
const GRAPH: Duration = Duration::from_millis(100);
/// The grace period for the last commands to arrive.
const GRACE_PERIOD: Duration = Duration::from_millis(200);
const SCAN: [&str; 2] = ["sensor_msgs", "LaserScan"];
const ODOMETRY: [&str; 2] = ["nav_msgs", "Odometry"];
const TRANSFORMS: [&str; 2] = ["tf2_msgs", "TFMessage"];
const JOINTS: [&str; 2] = ["sensor_msgs", "JointState"];

/// A report of an event during a drive.
#[derive(Debug)]
pub enum DriveReport<'a> {
    /// The driver made a decision, or an action ended.
    Step(&'a DriverStep),
    /// The faults changed. Empty if the drive continues.
    Faults(&'a [Fault]),
}

/// The result of a drive.
#[derive(Debug, Clone)]
pub struct DriveSummary {
    /// The final phase.
    pub phase: Phase,
    /// The number of decisions.
    pub decisions: u32,
    /// The faults at the end.
    pub faults: Vec<Fault>,
    /// The latency from the time a scan was sent, by its publisher's clock, until the command was
    /// published.
    pub latency: Latency,
}

struct DriveNode {
    link: Link,
    scan: Subscription<LaserScan>,
    odom: Subscription<Odometry>,
    imu: Subscription<Imu>,
    tf_static: Subscription<Transforms>,
    /// The transforms of another localiser.
    localiser: Option<Subscription<Transforms>>,
    initial_pose: Option<Subscription<EstimatedPose>>,
    joints: Option<Subscription<JointState>>,
    clock: Option<Subscription<Clock>>,
    cmd_vel: Option<Velocity>,
    /// The message type of commands.
    velocity: [&'static str; 2],
    /// Transforms; `None` in a dry run, and with another localiser.
    tf: Option<Publisher<Transforms>>,
    pose: Publisher<EstimatedPose>,
    decision: Publisher<Text>,
    fault: Publisher<Text>,
    diagnostics: Publisher<DiagnosticArray>,
    state: Diagnostics,
    clock_ns: Option<u64>,
    network: Network,
    looked: Option<Instant>,
}

/// The messages taken from the topics.
struct Taken {
    readings: Readings,
    /// The time at which the newest scan was sent, in nanoseconds since 1970.
    scan_sent_ns: Option<i64>,
}

impl DriveNode {
    fn open(options: &DriverOptions) -> Result<Self, Error> {
        let mut link = Link::open("xcscr_driver", &options.node)?;
        let text = ["std_msgs", "String"];
        let clock = ["rosgraph_msgs", "Clock"];
        let pose = ["geometry_msgs", "PoseWithCovarianceStamped"];
        Ok(Self {
            scan: link.subscription("scan", SCAN, &best_effort())?,
            odom: link.subscription("odom", ODOMETRY, &best_effort())?,
            imu: link.subscription("imu", ["sensor_msgs", "Imu"], &best_effort())?,
            tf_static: link.subscription("tf_static", TRANSFORMS, &latched())?,
            localiser: match options.source {
                PoseSource::Own => None,
                PoseSource::Tf => Some(link.subscription("tf", TRANSFORMS, &best_effort())?),
            },
            initial_pose: match options.source {
                PoseSource::Own => Some(link.subscription("initialpose", pose, &best_effort())?),
                PoseSource::Tf => None,
            },
            joints: if options.reads_joints {
                Some(link.subscription("joint_states", JOINTS, &best_effort())?)
            } else {
                None
            },
            clock: if options.sim_time {
                Some(link.subscription("clock", clock, &best_effort())?)
            } else {
                None
            },
            cmd_vel: if options.dry_run {
                None
            } else {
                Some(Velocity::open(&mut link, options.stamped)?)
            },
            velocity: if options.stamped { STAMPED } else { TWIST },
            tf: match (options.dry_run, options.source) {
                (false, PoseSource::Own) => Some(link.publisher("tf", TRANSFORMS, &reliable())?),
                _ => None,
            },
            pose: link.publisher("xcscr/pose", pose, &reliable())?,
            decision: link.publisher("xcscr/decision", text, &reliable())?,
            fault: link.publisher("xcscr/fault", text, &reliable())?,
            diagnostics: link.publisher(
                "/diagnostics",
                ["diagnostic_msgs", "DiagnosticArray"],
                &reliable(),
            )?,
            state: Diagnostics::default(),
            clock_ns: None,
            network: Network::default(),
            looked: None,
            link,
        })
    }

    fn take(&mut self) -> Taken {
        for (clock, _) in self.clock.iter().flat_map(drain) {
            self.clock_ns = Some(clock.clock.nanoseconds());
        }
        let odometry = drain(&self.odom);
        let imu = drain(&self.imu);
        let scans = drain(&self.scan);
        if self.looked.is_none_or(|at| at.elapsed() >= GRAPH) {
            self.look();
        }
        Taken {
            scan_sent_ns: scans.last().map(|(_, sent_ns)| *sent_ns),
            readings: Readings {
                scans: scans.iter().map(|(scan, _)| scan.into()).collect(),
                odometry: odometry
                    .iter()
                    .map(|(odometry, _)| odometry.into())
                    .collect(),
                imu: imu.iter().map(|(imu, _)| imu.into()).collect(),
                static_transforms: transforms(Some(&self.tf_static)),
                transforms: transforms(self.localiser.as_ref()),
                initial_poses: converted(self.initial_pose.as_ref()),
                joints: converted(self.joints.as_ref()),
                clock_ns: self.clock_ns,
                network: self.network.clone(),
            },
        }
    }

    /// Checks the ROS graph for other publishers and incompatible peers.
    fn look(&mut self) {
        self.looked = Some(Instant::now());
        let own = self.cmd_vel.as_ref().map(Velocity::gid);
        let others = |own| self.link.other_publishers("cmd_vel", own);
        // In a dry run others may drive the robot.
        let other_publishers = own.map_or(0, others);
        let link = &self.link;
        let named = |topic: &str, cause: Option<String>| Some((format!("/{topic}"), cause?));
        let incompatible = [
            named("scan", link.writer_fault("scan", SCAN, &best_effort())),
            named("odom", link.writer_fault("odom", ODOMETRY, &best_effort())),
            named(
                "cmd_vel",
                own.and_then(|_| link.reader_fault("cmd_vel", self.velocity, &reliable())),
            ),
        ];
        self.network = Network {
            other_publishers,
            incompatible: incompatible.into_iter().flatten().collect(),
        };
    }

    /// Returns the time of sending: simulated time if there is any, otherwise that of this machine.
    fn now_ns(&self) -> u64 {
        self.clock_ns.unwrap_or_else(unix_ns)
    }

    fn publish(&mut self, step: &DriverStep) -> Result<(), Error> {
        if let Some(cmd_vel) = &self.cmd_vel {
            cmd_vel.publish(self.now_ns(), step.command)?;
        }
        // The rest is for display only; a full queue drops it.
        if let Some(belief) = &step.belief {
            let frames = [(MAP, ODOM, belief.odom_in_map)];
            if let Some(tf) = &self.tf {
                let _ = tf.publish(Transforms::new(belief.stamp_ns, &frames));
            }
            let _ = self.pose.publish(belief.into());
        }
        if let Some(decision) = &step.decision {
            let _ = self.decision.publish(Text::new(decision.words.clone()));
        }
        if let Some(message) = self.state.of(self.now_ns(), step) {
            let _ = self.diagnostics.publish(message);
        }
        Ok(())
    }
}

/// Returns the waiting messages of a topic as readings.
fn converted<M, R>(topic: Option<&Subscription<M>>) -> Vec<R>
where
    M: DeserializeOwned + 'static,
    R: for<'a> From<&'a M>,
{
    let messages = topic.into_iter().flat_map(drain);
    messages.map(|(message, _)| R::from(&message)).collect()
}

/// Returns the waiting transforms of a topic.
fn transforms(topic: Option<&Subscription<Transforms>>) -> Vec<Transform> {
    let messages = topic.into_iter().flat_map(drain);
    let all = messages.flat_map(|(message, _)| message.transforms);
    all.map(|transform| Transform::from(&transform)).collect()
}

/// Commands rest when the drive ends for any reason, including a panic.
struct RestAtEnd(DriveNode);

impl Drop for RestAtEnd {
    fn drop(&mut self) {
        if let Some(cmd_vel) = &self.0.cmd_vel {
            for _ in 0..3 {
                let _ = cmd_vel.publish(self.0.now_ns(), Speeds::default());
            }
            sleep(GRACE_PERIOD);
        }
    }
}

/// Drives a robot until it is at the goal, out of steps or mislocalised, or `stop` returns true.
///
/// # Errors
/// Returns an error if the node or a topic cannot be created, a command cannot be sent, or the
/// recording cannot be written. The robot is commanded to rest first.
pub fn drive(
    driver: Driver,
    options: &DriverOptions,
    bag: Option<DriveBag>,
    stop: &dyn Fn() -> bool,
    report: &mut dyn FnMut(DriveReport<'_>),
) -> Result<DriveSummary, Error> {
    let mut drive = Drive {
        node: RestAtEnd(DriveNode::open(options)?),
        driver,
        bag,
        waiting: Readings::default(),
        decisions: 0,
        faults: Vec::new(),
        latencies_ms: Vec::new(),
    };
    let end = drive.follow(stop, report)?;
    let Drive {
        node,
        bag,
        decisions,
        latencies_ms,
        ..
    } = drive;
    // Command rest before waiting for the disk.
    drop(node);
    bag.map_or(Ok(()), DriveBag::finish)?;
    Ok(DriveSummary {
        phase: end.phase,
        decisions,
        faults: end.faults,
        latency: Latency::of(latencies_ms),
    })
}

/// The state of a drive.
struct Drive {
    node: RestAtEnd,
    driver: Driver,
    bag: Option<DriveBag>,
    /// Readings waiting for odometry or a scan.
    waiting: Readings,
    decisions: u32,
    /// The names of the last reported faults.
    faults: Vec<&'static str>,
    latencies_ms: Vec<f64>,
}

impl Drive {
    /// Calls the driver when messages arrive, and at least once per control period. Returns the
    /// last step.
    fn follow(
        &mut self,
        stop: &dyn Fn() -> bool,
        report: &mut dyn FnMut(DriveReport<'_>),
    ) -> Result<DriverStep, Error> {
        let (began, began_ns) = (Instant::now(), unix_ns());
        let mut last: Option<Instant> = None;
        loop {
            let Taken {
                mut readings,
                scan_sent_ns,
            } = self.node.0.take();
            readings.follow(std::mem::take(&mut self.waiting));
            let is_due = last.is_none_or(|at| at.elapsed() >= PERIOD);
            if readings.odometry.is_empty() && readings.scans.is_empty() && !is_due {
                self.waiting = readings;
                sleep(TICK);
                continue;
            }
            if stop() {
                self.driver.interrupt();
            }
            last = Some(Instant::now());
            let steady_ns = began_ns + began.elapsed().as_nanos() as u64;
            let step = self.driver.step(steady_ns, &readings);
            self.node.0.publish(&step)?;
            if let Some(sent_ns) = scan_sent_ns.filter(|&sent_ns| sent_ns > 0) {
                let passed_ms = (unix_ns() as f64 - sent_ns as f64) * 1e-6;
                self.latencies_ms.push(passed_ms);
            }
            self.report(&step, report);
            if let Some(bag) = &mut self.bag {
                bag.step(steady_ns, &readings, &step)?;
            }
            let is_over = matches!(step.phase, Phase::AtGoal | Phase::OutOfSteps);
            if is_over || step.faults.iter().any(Fault::is_final) {
                return Ok(step);
            }
        }
    }

    fn report(&mut self, step: &DriverStep, report: &mut dyn FnMut(DriveReport<'_>)) {
        let names: Vec<_> = step.faults.iter().map(Fault::name).collect();
        if names != self.faults {
            self.faults = names;
            let words: Vec<String> = step.faults.iter().map(Fault::to_string).collect();
            let _ = self.node.0.fault.publish(Text::new(words.join("; ")));
            report(DriveReport::Faults(&step.faults));
        }
        self.decisions += u32::from(step.decision.is_some());
        if step.decision.is_some() || step.outcome.is_some() {
            report(DriveReport::Step(step));
        }
    }
}

fn unix_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_nanos() as u64)
}
