//! Errors of the nodes.

use crate::record::RecordError;

/// Why a node cannot run.
#[derive(Debug, thiserror::Error)]
pub enum Ros2Error {
    /// The node, a topic, a publisher or a subscription cannot be made.
    #[error("cannot make {what} for ROS 2: {cause}")]
    Create {
        /// What cannot be made.
        what: String,
        /// What the middleware says.
        cause: String,
    },
    /// A message cannot be sent.
    #[error("cannot publish on {topic}: {cause}")]
    Publish {
        /// The topic.
        topic: &'static str,
        /// What the middleware says.
        cause: String,
    },
    /// The drive cannot be recorded.
    #[error(transparent)]
    Record(#[from] RecordError),
}
