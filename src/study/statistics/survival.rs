//! Censored waiting times: Kaplan-Meier curves and the log-rank test.

use std::collections::BTreeMap;

use statrs::function::erf::erfc;

use super::Z_95;

/// A waiting time, possibly censored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lifetime {
    /// The time of the event, or of the last observation (censored).
    pub time: u32,
    /// Whether the event happened.
    pub happened: bool,
}

/// A step of a survival curve: from `time` on, the share `value` still waits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The time at which the step begins.
    pub time: u32,
    /// The share that still waits.
    pub value: f64,
    /// Its lower 95 % limit.
    pub low: f64,
    /// Its upper 95 % limit.
    pub high: f64,
}

/// The Kaplan-Meier estimate (1958) of the share that still waits.
#[derive(Debug, Clone, PartialEq)]
pub struct Survival {
    points: Vec<Point>,
}

impl Survival {
    /// Computes the curve of these waiting times. The limits use Greenwood's variance on the
    /// log(-log) scale, which keeps them within \[0, 1\].
    pub fn new(lifetimes: &[Lifetime]) -> Self {
        let mut points = vec![Point {
            time: 0,
            value: 1.0,
            low: 1.0,
            high: 1.0,
        }];
        let (mut value, mut greenwood) = (1.0, 0.0);
        for EventTime {
            time,
            waiting,
            events,
        } in event_times(lifetimes)
        {
            value *= 1.0 - events / waiting;
            greenwood += events / (waiting * (waiting - events));
            let (low, high) = limits(value, greenwood);
            points.push(Point {
                time,
                value,
                low,
                high,
            });
        }
        Self { points }
    }

    /// Returns the steps of the curve, beginning at time 0.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Returns the first time at which at most the share `q` still waits, or `None` if there is
    /// none.
    pub fn time_when_left(&self, q: f64) -> Option<u32> {
        // Products of fractions miss round numbers by a few units in the last place.
        let reached = |point: &&Point| point.value <= q + 1e-12;
        self.points.iter().find(reached).map(|point| point.time)
    }
}

fn limits(value: f64, greenwood: f64) -> (f64, f64) {
    if value <= 0.0 {
        return (0.0, 0.0);
    }
    let spread = Z_95 * greenwood.sqrt() / value.ln();
    (value.powf((-spread).exp()), value.powf(spread.exp()))
}

/// A time with events, the number still waiting just before it, and the number of events.
struct EventTime {
    time: u32,
    waiting: f64,
    events: f64,
}

/// Returns the times with events, in order.
fn event_times(lifetimes: &[Lifetime]) -> Vec<EventTime> {
    let mut sorted = lifetimes.to_vec();
    sorted.sort_unstable_by_key(|one| one.time);
    let (mut event_times, mut left) = (Vec::new(), sorted.len());
    for same in sorted.chunk_by(|a, b| a.time == b.time) {
        let events = same.iter().filter(|one| one.happened).count();
        if events > 0 {
            event_times.push(EventTime {
                time: same[0].time,
                waiting: left as f64,
                events: events as f64,
            });
        }
        left -= same.len();
    }
    event_times
}

/// Returns the p of the log-rank test (Mantel 1966) that two groups have the same waiting times.
pub fn log_rank(a: &[Lifetime], b: &[Lifetime]) -> f64 {
    let both = [a, b].concat();
    let events_of_a: BTreeMap<u32, f64> = event_times(a)
        .iter()
        .map(|event| (event.time, event.events))
        .collect();
    let mut times_of_a: Vec<u32> = a.iter().map(|one| one.time).collect();
    times_of_a.sort_unstable();
    let (mut excess, mut variance) = (0.0, 0.0);
    for EventTime {
        time,
        waiting: all,
        events: came,
    } in event_times(&both)
    {
        let gone = times_of_a.partition_point(|&other| other < time);
        let waiting_a = (times_of_a.len() - gone) as f64;
        let waiting_b = all - waiting_a;
        excess += events_of_a.get(&time).copied().unwrap_or(0.0) - came * waiting_a / all;
        if all > 1.0 {
            variance += came * (waiting_a / all) * (waiting_b / all) * (all - came) / (all - 1.0);
        }
    }
    if variance == 0.0 {
        return 1.0;
    }
    // The upper tail of chi-squared with one degree of freedom.
    erfc((excess * excess / variance / 2.0).sqrt()).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::statistics::assert_close;

    /// The remission times of leukaemia patients in weeks (Freireich and others 1963), with 6-MP
    /// and with placebo. A plus marks a censored time.
    const TREATED: &str = "6 6 6 6+ 7 9+ 10 10+ 11+ 13 16 17+ 19+ 20+ 22 23 25+ 32+ 32+ 34+ 35+";
    const PLACEBO: &str = "1 1 2 2 3 4 4 5 5 8 8 8 8 11 11 12 12 15 17 22 23";

    fn lifetimes(text: &str) -> Vec<Lifetime> {
        let one = |word: &str| Lifetime {
            time: word.trim_end_matches('+').parse().unwrap(),
            happened: !word.ends_with('+'),
        };
        text.split(' ').map(one).collect()
    }

    #[test]
    fn the_curve_and_its_limits_as_in_lifelines() {
        // lifelines 0.30.3: KaplanMeierFitter().fit(t, e).survival_function_ and
        // .confidence_interval_ (log-log by default)
        let curve = Survival::new(&lifetimes(TREATED));
        for (time, value, low, high) in LIFELINES {
            let point = curve
                .points()
                .iter()
                .find(|point| point.time == time)
                .unwrap();
            assert_close(point.value, value);
            assert_close(point.low, low);
            assert_close(point.high, high);
        }
    }

    const LIFELINES: [(u32, f64, f64, f64); 3] = [
        (6, 0.857142857142857, 0.6197179552659838, 0.9515517476469969),
        (
            13,
            0.6901960784313722,
            0.43161022248618386,
            0.8490659633494505,
        ),
        (
            23,
            0.44817927170868327,
            0.18805200595923233,
            0.6801426284952412,
        ),
    ];

    #[test]
    fn medians_as_in_lifelines() {
        // lifelines 0.30.3: KaplanMeierFitter().fit(t, e).median_survival_time_
        assert_eq!(
            Survival::new(&lifetimes(TREATED)).time_when_left(0.5),
            Some(23)
        );
        assert_eq!(
            Survival::new(&lifetimes(PLACEBO)).time_when_left(0.5),
            Some(8)
        );
        assert_eq!(Survival::new(&lifetimes("5+ 5+")).time_when_left(0.5), None);
    }

    #[test]
    fn the_log_rank_test_as_in_lifelines() {
        // lifelines 0.30.3: logrank_test(t1, t2, e1, e2).p_value
        let (treated, placebo) = (lifetimes(TREATED), lifetimes(PLACEBO));
        assert_close(log_rank(&treated, &placebo), LOG_RANK);
        assert_close(log_rank(&placebo, &treated), LOG_RANK);
        assert_eq!(log_rank(&treated, &treated), 1.0);
        assert_eq!(log_rank(&lifetimes("5+"), &lifetimes("5+")), 1.0);
    }

    const LOG_RANK: f64 = 4.168809109334511e-5;
}
