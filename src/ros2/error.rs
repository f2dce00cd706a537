//! Errors of the ROS 2 nodes.

use crate::record::RecordError;

/// Errors of a ROS 2 node.
#[derive(Debug, thiserror::Error)]
pub enum Ros2Error {
    /// The node, a topic, a publisher or a subscription cannot be created.
    #[error("cannot create {what} for ROS 2: {cause}")]
    Create {
        /// The object that cannot be created.
        what: String,
        /// The error of the middleware.
        cause: String,
    },
    /// A message cannot be sent.
    #[error("cannot publish on {topic}: {cause}")]
    Publish {
        /// The topic.
        topic: &'static str,
        /// The error of the middleware.
        cause: String,
    },
    /// The drive cannot be recorded.
    #[error(transparent)]
    Record(#[from] RecordError),
}
