//! A ROS 2 node and its topics.

use std::net::Ipv4Addr;

use ros2_client::dds::rustdds::discovery::PublicationBuiltinTopicData;
use ros2_client::dds::rustdds::{DomainParticipantBuilder, Topic};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::ros2::QosPolicies;
use ros2_client::{
    Context, Gid, MessageTypeName, Name, Node, NodeName, NodeOptions as RosNodeOptions, Publisher,
    QosProfile, Subscription,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::drive::NodeOptions;
use crate::{Error, ErrorKind};

/// Quality of service for sensor messages, which may be lost. Compatible with every publisher of
/// the same type.
pub fn best_effort() -> QosProfile {
    QosProfile::subscription_default().history(History::KeepLast { depth: 32 })
}

/// Quality of service for reliable messages. A full queue drops them, so that an unresponsive peer
/// cannot block the robot.
pub fn reliable() -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth: 10 })
}

/// Quality of service for a message that is also delivered to later subscribers.
pub fn transient_local() -> QosProfile {
    reliable()
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 1 })
}

/// Quality of service for messages that were sent before the subscription.
pub fn latched() -> QosProfile {
    QosProfile::subscription_default()
        .reliability_reliable(WhenFull::Fail)
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 100 })
}

/// The package and the name of the message types of commands.
pub const TWIST: [&str; 2] = ["geometry_msgs", "Twist"];
pub const STAMPED: [&str; 2] = ["geometry_msgs", "TwistStamped"];

/// A ROS 2 node.
pub struct Link {
    context: Context,
    node: Node,
    options: NodeOptions,
}

impl Link {
    /// Opens a node with a name.
    pub fn open(name: &str, options: &NodeOptions) -> Result<Self, Error> {
        let other = options.remaps.iter().find(|(from, _)| from == "__node");
        let name = other.map_or(name, |(_, to)| to);
        let what = || format!("the node `{name}` in the namespace `{}`", options.namespace);
        let mut participant = DomainParticipantBuilder::new(options.domain);
        if options.localhost_only {
            participant = participant.with_only_networks([Ipv4Addr::LOCALHOST]);
        }
        let participant = participant.build().map_err(failed(what()))?;
        let context = Context::from_domain_participant(participant).map_err(failed(what()))?;
        let node_name = NodeName::new(&options.namespace, name).map_err(failed(what()))?;
        let node = context
            .new_node(node_name, RosNodeOptions::new().enable_rosout(false))
            .map_err(failed(what()))?;
        Ok(Self {
            context,
            node,
            options: options.clone(),
        })
    }

    /// Returns the full name of a topic.
    fn name(&self, topic: &str) -> Result<Name, Error> {
        let full = self.options.topic(topic);
        let (folder, base) = full.rsplit_once('/').unwrap_or(("", &full));
        let folder = if folder.is_empty() { "/" } else { folder };
        Name::new(folder, base).map_err(failed(format!("the topic `{full}`")))
    }

    /// Creates a topic with a message type.
    fn topic(
        &self,
        topic: &str,
        [package, kind]: [&str; 2],
        qos: &QosProfile,
    ) -> Result<Topic, Error> {
        let (name, kind) = (self.name(topic)?, MessageTypeName::new(package, kind));
        let made = self.node.create_topic(&name, kind, qos);
        made.map_err(failed(format!("the topic `{topic}`")))
    }

    /// Creates a publisher on a topic.
    pub fn publisher<M: Serialize>(
        &mut self,
        topic: &str,
        kind: [&str; 2],
        qos: &QosProfile,
    ) -> Result<Publisher<M>, Error> {
        let made = self.topic(topic, kind, qos)?;
        let published = self.node.create_publisher(&made, None);
        published.map_err(failed(format!("the publisher on `{topic}`")))
    }

    /// Creates a subscription to a topic.
    pub fn subscription<M: DeserializeOwned + 'static>(
        &mut self,
        topic: &str,
        kind: [&str; 2],
        qos: &QosProfile,
    ) -> Result<Subscription<M>, Error> {
        let made = self.topic(topic, kind, qos)?;
        let subscribed = self.node.create_subscription(&made, None);
        subscribed.map_err(failed(format!("the subscription to `{topic}`")))
    }

    /// Returns the name of a topic in DDS.
    fn dds_name(&self, topic: &str) -> String {
        format!("rt{}", self.options.topic(topic))
    }

    /// Returns the number of publishers on a topic other than `own`.
    pub fn other_publishers(&self, topic: &str, own: Gid) -> usize {
        let name = self.dds_name(topic);
        let writers = self.context.domain_participant().discovered_writers();
        let is_other = |data: &&PublicationBuiltinTopicData| {
            data.topic_name == name && Gid::from(data.key) != own
        };
        let all = writers.iter().map(|writer| &writer.publication_topic_data);
        all.filter(is_other).count()
    }

    /// Returns why a publisher on a topic is incompatible with a subscription of this quality;
    /// `None` if all are compatible.
    pub fn writer_fault(
        &self,
        topic: &str,
        kind: [&str; 2],
        wanted: &QosProfile,
    ) -> Option<String> {
        let name = self.dds_name(topic);
        let wanted = QosPolicies::from(wanted);
        let writers = self.context.domain_participant().discovered_writers();
        writers.iter().find_map(|writer| {
            let data = &writer.publication_topic_data;
            if data.topic_name != name {
                return None;
            }
            let found = other_type(&data.type_name, kind);
            let policy = || data.qos().compliance_failure_wrt(&wanted);
            found.or_else(|| policy().map(|p| format!("the publisher differs in {p:?}")))
        })
    }

    /// Returns why the subscribers of a topic are incompatible with a publisher of this quality;
    /// `None` if any is compatible, or there are none.
    pub fn reader_fault(
        &self,
        topic: &str,
        kind: [&str; 2],
        offered: &QosProfile,
    ) -> Option<String> {
        let name = self.dds_name(topic);
        let offered = QosPolicies::from(offered);
        let readers = self.context.domain_participant().discovered_readers();
        let mut faults = Vec::new();
        for reader in &readers {
            let data = &reader.subscription_topic_data;
            if *data.topic_name() != name {
                continue;
            }
            let policy = || offered.compliance_failure_wrt(&data.qos());
            let fault = other_type(data.type_name(), kind)
                .or_else(|| policy().map(|p| format!("the subscriber differs in {p:?}")));
            faults.push(fault?);
        }
        faults.into_iter().next()
    }
}

/// Returns the difference between a type in DDS and the expected type, if any.
fn other_type(found: &str, [package, kind]: [&str; 2]) -> Option<String> {
    let wanted = MessageTypeName::new(package, kind).dds_msg_type();
    (found != wanted).then(|| format!("its type is {found}, not {wanted}"))
}

/// Converts an error in creating `what`.
pub fn failed<E: std::fmt::Debug>(what: String) -> impl FnOnce(E) -> Error {
    move |cause| ErrorKind::Io.error(format!("cannot create {what} for ROS 2: {cause:?}"))
}

/// The most messages that are taken at once, so that a fast publisher cannot keep the robot from its
/// next command.
const MOST_MESSAGES: usize = 100;

/// Returns the waiting messages. Messages that cannot be decoded are dropped.
pub fn drain<M: DeserializeOwned + 'static>(subscription: &Subscription<M>) -> Vec<(M, i64)> {
    let mut all = Vec::new();
    for _ in 0..MOST_MESSAGES {
        match subscription.take() {
            Ok(Some((message, info))) => {
                let sent = info.source_timestamp();
                all.push((message, sent.map_or(0, |at| at.to_nanos())));
            }
            Ok(None) => break,
            // A message that cannot be decoded is removed from the queue as well.
            Err(_) => {}
        }
    }
    all
}
