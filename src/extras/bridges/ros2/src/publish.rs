//! The writers of the topics.

use std::{collections::BTreeMap, net::Ipv4Addr};

use rustdds::{
    DomainParticipant, DomainParticipantBuilder, QosPolicies, QosPolicyBuilder, TopicKind,
    no_key::DataWriter,
    policy::{Durability, History, Reliability},
};
use serde::Serialize;

use crate::topics::{Data, OperatingState, PoseStamped, Sample, Side, Topic, WrenchStamped};

enum Writer {
    Pose(DataWriter<PoseStamped>),
    Wrench(DataWriter<WrenchStamped>),
    State(DataWriter<OperatingState>),
}

pub struct Publisher {
    writers: BTreeMap<(Side, Topic), Writer>,
    /// Dropping it ends the publication.
    _participant: DomainParticipant,
}

/// Reliable, so that it matches readers of either kind; only the newest sample is kept, so that no reader waits for old
/// ones.
fn usual() -> QosPolicyBuilder {
    QosPolicyBuilder::new()
        .reliability(Reliability::Reliable { max_blocking_time: rustdds::Duration::ZERO })
        .history(History::KeepLast { depth: 1 })
}

impl Publisher {
    /// Publishes in this domain and namespace; announced only in the networks of these addresses, or in all of them.
    pub fn new(domain: u16, networks: &[Ipv4Addr], namespace: &str) -> Result<Self, String> {
        let mut builder = DomainParticipantBuilder::new(domain);
        if !networks.iter().any(Ipv4Addr::is_unspecified) {
            builder = builder.with_only_networks(networks.iter().copied());
        }
        let participant = builder.build().map_err(|error| error.to_string())?;
        let writers =
            Side::ALL.into_iter().flat_map(|side| Topic::ALL.map(|topic| (side, topic))).map(|(side, topic)| {
                // ROS 2's naming of topics and types in DDS.
                let name = format!("rt/{namespace}/{}/{}", side.word(), topic.name());
                Ok(((side, topic), writer(&participant, &name, topic)?))
            });
        let writers = writers.collect::<Result<_, String>>()?;
        Ok(Self { writers, _participant: participant })
    }

    /// Publishes samples. A sample that cannot be written now is superseded by the next one.
    pub fn publish(&self, samples: &[Sample]) {
        for sample in samples {
            self.write(sample);
        }
    }

    fn write(&self, sample: &Sample) {
        match (self.writers.get(&(sample.side, sample.topic)), &sample.data) {
            (Some(Writer::Pose(writer)), Data::Pose(pose)) => drop(writer.write(pose.clone(), None)),
            (Some(Writer::Wrench(writer)), Data::Wrench(wrench)) => drop(writer.write(wrench.clone(), None)),
            (Some(Writer::State(writer)), Data::State(state)) => drop(writer.write(state.clone(), None)),
            _ => {}
        }
    }
}

fn writer(participant: &DomainParticipant, name: &str, topic: Topic) -> Result<Writer, String> {
    Ok(match topic {
        Topic::MeasuredCp | Topic::SetpointCp => {
            Writer::Pose(of_type(participant, name, "geometry_msgs::msg::dds_::PoseStamped_", &usual().build())?)
        }
        Topic::MeasuredCf | Topic::RenderedCf => {
            Writer::Wrench(of_type(participant, name, "geometry_msgs::msg::dds_::WrenchStamped_", &usual().build())?)
        }
        // A late reader gets the state at once.
        Topic::OperatingState => {
            let qos = usual().durability(Durability::TransientLocal).build();
            Writer::State(of_type(participant, name, "crtk_msgs::msg::dds_::OperatingState_", &qos)?)
        }
    })
}

fn of_type<D: Serialize>(
    participant: &DomainParticipant,
    name: &str,
    kind: &str,
    qos: &QosPolicies,
) -> Result<DataWriter<D>, String> {
    let publisher = participant.create_publisher(qos).map_err(|error| error.to_string())?;
    let topic = participant.create_topic(name.to_owned(), kind.to_owned(), qos, TopicKind::NoKey);
    let topic = topic.map_err(|error| error.to_string())?;
    publisher.create_datawriter_no_key_cdr(&topic, None).map_err(|error| error.to_string())
}
