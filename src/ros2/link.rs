//! A node with its topics.

use ros2_client::dds::rustdds::discovery::PublicationBuiltinTopicData;
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::ros2::QosPolicies;
use ros2_client::{
    Context, ContextOptions, Gid, MessageTypeName, Name, Node, NodeName,
    NodeOptions as RosNodeOptions, Publisher, QosProfile, Subscription,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::Ros2Error;
use crate::drive::NodeOptions;

/// Messages that may be lost, as of sensors. Hears every publisher of the same type.
pub fn heard() -> QosProfile {
    QosProfile::subscription_default().history(History::KeepLast { depth: 32 })
}

/// Messages that arrive. A full queue loses them, so that a deaf peer cannot hold up the robot.
pub fn told() -> QosProfile {
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Fail)
        .history(History::KeepLast { depth: 10 })
}

/// The last message, also for those who subscribe later.
pub fn lasting() -> QosProfile {
    told()
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 1 })
}

/// A node.
pub struct Link {
    context: Context,
    node: Node,
    namespace: String,
}

impl Link {
    /// Opens a node of a name.
    pub fn open(name: &str, options: &NodeOptions) -> Result<Self, Ros2Error> {
        let what = || format!("the node `{name}` in the namespace `{}`", options.namespace);
        let context = Context::with_options(ContextOptions::new().domain_id(options.domain))
            .map_err(failed(what()))?;
        let node_name = NodeName::new(&options.namespace, name).map_err(failed(what()))?;
        let node = context
            .new_node(node_name, RosNodeOptions::new().enable_rosout(false))
            .map_err(failed(what()))?;
        Ok(Self {
            context,
            node,
            namespace: options.namespace.clone(),
        })
    }

    /// The full name of a topic.
    fn name(&self, topic: &str) -> Result<Name, Ros2Error> {
        let (folder, base) = topic.rsplit_once('/').unwrap_or(("", topic));
        let namespace = match topic {
            "clock" => "",
            _ => self.namespace.trim_matches('/'),
        };
        let parts = [namespace, folder].map(|part| match part {
            "" => String::new(),
            part => format!("/{part}"),
        });
        let whole = match parts.concat() {
            none if none.is_empty() => "/".to_owned(),
            whole => whole,
        };
        Name::new(&whole, base).map_err(failed(format!("the topic `{topic}`")))
    }

    /// Publishes on a topic.
    pub fn publisher<M: Serialize>(
        &mut self,
        topic: &str,
        [package, kind]: [&str; 2],
        qos: &QosProfile,
    ) -> Result<Publisher<M>, Ros2Error> {
        let what = || format!("the publisher on `{topic}`");
        let made =
            self.node
                .create_topic(&self.name(topic)?, MessageTypeName::new(package, kind), qos);
        let made = made.map_err(failed(what()))?;
        self.node
            .create_publisher(&made, None)
            .map_err(failed(what()))
    }

    /// Subscribes to a topic.
    pub fn subscription<M: DeserializeOwned + 'static>(
        &mut self,
        topic: &str,
        [package, kind]: [&str; 2],
        qos: &QosProfile,
    ) -> Result<Subscription<M>, Ros2Error> {
        let what = || format!("the subscription to `{topic}`");
        let made =
            self.node
                .create_topic(&self.name(topic)?, MessageTypeName::new(package, kind), qos);
        let made = made.map_err(failed(what()))?;
        self.node
            .create_subscription(&made, None)
            .map_err(failed(what()))
    }

    /// The name of a topic in DDS.
    fn dds_name(&self, topic: &str) -> String {
        match self.namespace.trim_matches('/') {
            "" => format!("rt/{topic}"),
            namespace => format!("rt/{namespace}/{topic}"),
        }
    }

    /// How many publishers on a topic there are beside `own`.
    pub fn other_publishers(&self, topic: &str, own: Option<Gid>) -> usize {
        let name = self.dds_name(topic);
        let writers = self.context.domain_participant().discovered_writers();
        let is_other = |data: &&PublicationBuiltinTopicData| {
            data.topic_name == name && Some(Gid::from(data.key)) != own
        };
        let all = writers.iter().map(|writer| &writer.publication_topic_data);
        all.filter(is_other).count()
    }

    /// Why a publisher on a topic cannot be heard by a subscription of such quality; `None` if all can be heard.
    pub fn unheard(&self, topic: &str, kind: [&str; 2], wanted: &QosProfile) -> Option<String> {
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

    /// Why the subscribers of a topic cannot hear a publisher of such quality; `None` if one can, or there is none.
    pub fn unhearing(&self, topic: &str, kind: [&str; 2], offered: &QosProfile) -> Option<String> {
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

/// What is wrong with a type in DDS.
fn other_type(found: &str, [package, kind]: [&str; 2]) -> Option<String> {
    let wanted = MessageTypeName::new(package, kind).dds_msg_type();
    (found != wanted).then(|| format!("its type is {found}, not {wanted}"))
}

/// An error in making something.
pub fn failed<E: std::fmt::Debug>(what: String) -> impl FnOnce(E) -> Ros2Error {
    move |cause| Ros2Error::Create {
        what,
        cause: format!("{cause:?}"),
    }
}

/// All messages that wait; those that cannot be read are dropped.
pub fn drain<M: DeserializeOwned + 'static>(subscription: &Subscription<M>) -> Vec<(M, i64)> {
    let mut all = Vec::new();
    loop {
        match subscription.take() {
            Ok(Some((message, info))) => {
                let sent = info.source_timestamp();
                all.push((message, sent.map_or(0, |at| at.to_nanos())));
            }
            Ok(None) => return all,
            // A message that cannot be decoded is taken from the queue all the same.
            Err(_) if all.len() < 1_000 => {}
            Err(_) => return all,
        }
    }
}
