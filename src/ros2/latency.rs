//! The latency of commands.

/// The latency from a scan to the next command, in milliseconds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Latency {
    /// The number of scans.
    pub count: usize,
    /// The median.
    pub median_ms: f64,
    /// The 99th percentile.
    pub p99_ms: f64,
    /// The maximum.
    pub most_ms: f64,
}

impl Latency {
    /// Computes the latency from those of all scans.
    pub(super) fn of(mut all_ms: Vec<f64>) -> Self {
        all_ms.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = all_ms.len().checked_sub(1)?;
            all_ms.get((share * last as f64).ceil() as usize).copied()
        };
        Self {
            count: all_ms.len(),
            median_ms: at(0.5).unwrap_or(0.0),
            p99_ms: at(0.99).unwrap_or(0.0),
            most_ms: at(1.0).unwrap_or(0.0),
        }
    }
}
