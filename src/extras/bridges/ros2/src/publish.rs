//! The node and the writers of its topics.

use std::{collections::BTreeMap, net::Ipv4Addr};

use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher as Writer, QosProfile,
    dds::rustdds::DomainParticipantBuilder,
    qos::{Durability, History, WhenFull},
};
use serde::Serialize;

use crate::topics::{ArmSide, OperatingState, PoseStamped, Ros2Sample, Ros2Topic, TopicData, WrenchStamped};

/// Name of the node.
const NODE: &str = "nima_bridge_ros2";

enum OfTopic {
    Pose(Writer<PoseStamped>),
    Wrench(Writer<WrenchStamped>),
    State(Writer<OperatingState>),
}

pub struct Publisher {
    writers: BTreeMap<(ArmSide, Ros2Topic), OfTopic>,
    /// Dropping the node ends the publication.
    _node: Node,
}

/// Reliable, so that it matches readers of either kind; only the newest sample is kept, so that readers do not wait for
/// old ones.
fn usual() -> QosProfile {
    QosProfile::publisher_default().reliability_reliable(WhenFull::Fail).history(History::KeepLast { depth: 1 })
}

impl Publisher {
    /// Publishes in this domain and namespace. The topics are announced only in the networks of these addresses; the
    /// unspecified address stands for all networks.
    pub fn new(domain: u16, networks: &[Ipv4Addr], namespace: &str) -> Result<Self, String> {
        let mut builder = DomainParticipantBuilder::new(domain);
        if !networks.iter().any(Ipv4Addr::is_unspecified) {
            builder = builder.with_only_networks(networks.iter().copied());
        }
        let participant = builder.build().map_err(|error| error.to_string())?;
        let context = Context::from_domain_participant(participant).map_err(|error| error.to_string())?;
        let name = NodeName::new(&format!("/{namespace}"), NODE).map_err(|error| error.to_string())?;
        // The node only publishes: without a spinner and these services it receives nothing.
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let mut node = context.new_node(name, options).map_err(|error| error.to_string())?;
        let mut writers = BTreeMap::new();
        for (side, topic) in ArmSide::ALL.into_iter().flat_map(|side| Ros2Topic::ALL.map(|topic| (side, topic))) {
            let name = Name::new(&format!("/{namespace}/{}", side.word()), topic.name());
            let name = name.map_err(|error| error.to_string())?;
            writers.insert((side, topic), of_topic(&mut node, &name, topic)?);
        }
        Ok(Self { writers, _node: node })
    }

    /// Publishes samples. A sample that cannot be written now is superseded by the next one.
    pub fn publish(&self, samples: &[Ros2Sample]) {
        for sample in samples {
            self.write(sample);
        }
    }

    fn write(&self, sample: &Ros2Sample) {
        match (self.writers.get(&(sample.side, sample.topic)), &sample.data) {
            (Some(OfTopic::Pose(writer)), TopicData::Pose(pose)) => drop(writer.publish(pose.clone())),
            (Some(OfTopic::Wrench(writer)), TopicData::Wrench(wrench)) => drop(writer.publish(wrench.clone())),
            (Some(OfTopic::State(writer)), TopicData::State(state)) => drop(writer.publish(state.clone())),
            _ => {}
        }
    }
}

fn of_topic(node: &mut Node, name: &Name, topic: Ros2Topic) -> Result<OfTopic, String> {
    Ok(match topic {
        Ros2Topic::MeasuredCp | Ros2Topic::SetpointCp => {
            OfTopic::Pose(writer(node, name, ["geometry_msgs", "PoseStamped"], &usual())?)
        }
        Ros2Topic::MeasuredCf | Ros2Topic::RenderedCf => {
            OfTopic::Wrench(writer(node, name, ["geometry_msgs", "WrenchStamped"], &usual())?)
        }
        // A subscriber that joins late receives the state at once.
        Ros2Topic::OperatingState => {
            let qos = usual().durability(Durability::TransientLocal);
            OfTopic::State(writer(node, name, ["crtk_msgs", "OperatingState"], &qos)?)
        }
    })
}

fn writer<D: Serialize>(node: &mut Node, name: &Name, kind: [&str; 2], qos: &QosProfile) -> Result<Writer<D>, String> {
    let [package, kind] = kind;
    let topic = node.create_topic(name, MessageTypeName::new(package, kind), qos);
    let topic = topic.map_err(|error| error.to_string())?;
    node.create_publisher(&topic, None).map_err(|error| error.to_string())
}
