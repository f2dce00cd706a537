//! XCS for Python environments and tables.

use pyo3::prelude::*;
use xcs::bounds::OutOfRange;
use xcs::random::Stream;
use xcs::{Action, Condition, IntervalSettings, Intervals, Params, Representation};

use crate::learner::{Learner, Rule};
use crate::plan::invalid;

/// The number of table rows learned between two checks for signals such as Ctrl-C.
const TRIALS_AT_ONCE: u64 = 1000;
/// The number of the random stream that chooses table rows.
const ROWS_STREAM: u64 = 2;
/// The reward of a right answer. A wrong answer gets 0.
const RIGHT: f64 = 1000.0;

/// XCS with ternary or interval conditions. Percepts are bytes: eight-byte floats in native byte
/// order.
#[pyclass(module = "xcscr._native")]
pub struct Agent {
    learner: Box<dyn Learner>,
    width: usize,
    actions: usize,
}

/// Parses settings from JSON.
fn settings<T: serde::de::DeserializeOwned>(json: &str) -> PyResult<T> {
    serde_json::from_str(json).map_err(|fault| {
        let text = fault.to_string();
        invalid(text.split(" at line").next().unwrap_or(&text))
    })
}

/// Converts an error. The message uses the parameter names of the Python package.
fn out_of_range(fault: OutOfRange) -> PyErr {
    let text = fault.to_string();
    let text = text.replace("`xcsr.", "`").replace("`xcs.", "`");
    invalid(text.replace("`dont_care`", "`p_hash`"))
}

fn agent<C: Representation>(
    params: Params,
    settings: C::Settings,
    actions: usize,
    (gamma, exploration, error_share): (f64, f64, Option<f64>),
    seed: u64,
) -> PyResult<xcs::Agent<C>> {
    let mut agent = xcs::Agent::new(params, settings, actions, seed).map_err(out_of_range)?;
    (agent.gamma, agent.exploration, agent.error_share) = (gamma, exploration, error_share);
    Ok(agent)
}

impl Agent {
    /// Converts the bytes of one percept to numbers.
    fn percept(&self, bytes: &[u8]) -> PyResult<Vec<f64>> {
        let values = numbers(bytes);
        if values.len() == self.width {
            return Ok(values);
        }
        Err(invalid(format!(
            "the percept has {} values, but the learner has {}",
            values.len(),
            self.width
        )))
    }

    /// Converts the bytes of a table of percepts to numbers.
    fn table(&self, bytes: &[u8]) -> PyResult<Vec<f64>> {
        let values = numbers(bytes);
        match values.len().checked_rem(self.width) {
            Some(0) => Ok(values),
            _ => Err(invalid(
                "the table is not as wide as the learner's percepts",
            )),
        }
    }
}

/// Returns the right action with probability 1/2, and a random other action otherwise.
fn half_right(right: usize, actions: usize, stream: &mut Stream) -> usize {
    if actions < 2 || stream.below(2) == 0 {
        return right;
    }
    (right + 1 + stream.below(actions - 1)) % actions
}

/// Converts a buffer to eight-byte floats.
fn numbers(bytes: &[u8]) -> Vec<f64> {
    let (chunks, _) = bytes.as_chunks::<8>();
    chunks
        .iter()
        .map(|chunk| f64::from_ne_bytes(*chunk))
        .collect()
}

#[pymethods]
impl Agent {
    #[new]
    #[pyo3(signature = (intervals, width, actions, params, spreads, gamma, exploration, error_share, seed))]
    #[expect(clippy::too_many_arguments, reason = "called by xcscr.XCS only")]
    fn new(
        intervals: bool,
        width: usize,
        actions: usize,
        params: &str,
        spreads: &str,
        gamma: f64,
        exploration: f64,
        error_share: Option<f64>,
        seed: u64,
    ) -> PyResult<Self> {
        let params: Params = settings(params)?;
        let spreads: IntervalSettings = settings(spreads)?;
        spreads.check().map_err(out_of_range)?;
        for (key, value) in [("gamma", gamma), ("p_explore", exploration)] {
            xcs::bounds::within(key, value, 0.0..=1.0).map_err(out_of_range)?;
        }
        let rates = (gamma, exploration, error_share);
        let learner: Box<dyn Learner> = if intervals {
            xcs::bounds::within("n_features", width, 1..=1_000_000).map_err(out_of_range)?;
            Box::new(agent::<Intervals>(params, spreads, actions, rates, seed)?)
        } else {
            xcs::bounds::within("n_bits", width, 1..=xcs::MAX_PERCEPT_BITS)
                .map_err(out_of_range)?;
            Box::new(agent::<Condition>(params, (), actions, rates, seed)?)
        };
        Ok(Self {
            learner,
            width,
            actions,
        })
    }

    /// Chooses an action for a percept and stores its action set until `update`.
    fn act(&mut self, percept: &[u8], explores: bool) -> PyResult<usize> {
        let percept = self.percept(percept)?;
        let action = self.learner.act(&percept, explores).map_err(invalid)?;
        Ok(action.map_or(0, Action::index))
    }

    /// Learns from the reward of the last action. `next` is `None` if the episode ended.
    #[pyo3(signature = (reward, next))]
    fn update(&mut self, reward: f64, next: Option<&[u8]>) -> PyResult<()> {
        if !self.learner.is_waiting() {
            return Err(invalid(
                "no action waits for a reward: call act before update",
            ));
        }
        xcs::bounds::within("reward", reward, -1e12..=1e12).map_err(out_of_range)?;
        let next = next.map(|bytes| self.percept(bytes)).transpose()?;
        self.learner
            .update(reward, next.as_deref())
            .map_err(invalid)
    }

    /// Discards the action waiting for its reward.
    fn end_episode(&mut self) {
        self.learner.end_episode();
    }

    /// Learns from `trials` random rows of a table and their answers (one byte each). Half of the
    /// trials take the right action and the others any other action, so that rewards are as
    /// frequent as with two actions.
    fn learn_table(
        &mut self,
        py: Python<'_>,
        rows: &[u8],
        answers: &[u8],
        trials: u64,
        seed: u64,
    ) -> PyResult<()> {
        let rows = self.table(rows)?;
        if rows.is_empty() || rows.len() / self.width != answers.len() {
            return Err(invalid("pass at least one row, and one answer per row"));
        }
        let mut stream = Stream::new(seed, ROWS_STREAM);
        let (learner, width, actions) = (&mut self.learner, self.width, self.actions);
        let mut left = trials;
        while left > 0 {
            let now = left.min(TRIALS_AT_ONCE);
            py.detach(|| {
                (0..now).try_for_each(|_| {
                    let at = stream.below(answers.len());
                    let right = usize::from(answers[at]);
                    let taken = half_right(right, actions, &mut stream);
                    let action =
                        Action::new(taken).ok_or("an answer is not an action of the learner")?;
                    learner.take(&rows[at * width..][..width], action)?;
                    learner.update(if taken == right { RIGHT } else { 0.0 }, None)
                })
            })
            .map_err(|fault: String| invalid(fault))?;
            left -= now;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Drops rules that are not needed to choose the answers in the rows of a table. `answers` has one byte for each row.
    fn compact(&mut self, py: Python<'_>, rows: &[u8], answers: &[u8]) -> PyResult<()> {
        let table = self.table(rows)?;
        let rows = table.chunks(self.width).zip(answers);
        let rows = rows.filter_map(|(row, &answer)| Some((row, Action::new(answer.into())?)));
        let rows: Vec<_> = rows.collect();
        py.detach(|| self.learner.compact(&rows)).map_err(invalid)
    }

    /// Returns the value of each action in each percept of a table, as bytes of eight-byte floats;
    /// NaN if no rule advocates the action.
    fn values(&self, py: Python<'_>, rows: &[u8]) -> PyResult<Vec<u8>> {
        let rows = self.table(rows)?;
        let (learner, width) = (&self.learner, self.width);
        py.detach(|| {
            let mut bytes = Vec::with_capacity(rows.len() / width * self.actions * 8);
            for row in rows.chunks(width) {
                let values = learner.values(row)?.into_iter();
                values.for_each(|value| bytes.extend(value.unwrap_or(f64::NAN).to_ne_bytes()));
            }
            Ok(bytes)
        })
        .map_err(|fault: String| invalid(fault))
    }

    /// Returns the rules in population order: tests (attribute, lower, upper), action, prediction,
    /// error, fitness, numerosity, experience, set size, time stamp.
    fn rules(&self) -> Vec<Rule> {
        self.learner.rules()
    }

    /// The number of micro-classifiers.
    #[getter]
    fn numerosity(&self) -> u32 {
        self.learner.micro()
    }

    /// Returns the state of the learner as bytes.
    fn state(&self) -> PyResult<Vec<u8>> {
        self.learner.state().map_err(invalid)
    }

    /// Continues from the state of an agent with the same arguments.
    fn restore(&mut self, state: &[u8]) -> PyResult<()> {
        self.learner.restore(state, self.width).map_err(invalid)
    }
}
