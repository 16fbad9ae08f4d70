//! Users, sequences and protection zones that clients create and delete, with notifications of changes. They are only
//! stored: a created user cannot log in, and a protection zone stops no motion.

use nima_devices::kinova::messages::Rpc;
use prost::Message as _;

use super::{
    entity_store::EntityStore,
    forms::{ConfigurationChange, EntityHandle, NewUser, User},
    interface::{
        AnswerPayload, CONFIGURATION_TOPIC, CREATE_SEQUENCE, CREATE_USER, CREATE_ZONE, DELETE_SEQUENCE, DELETE_USER,
        DELETE_ZONE, InterfaceError, READ_USER, READ_USERS, READ_ZONE, READ_ZONES, UNSUPPORTED_METHOD, USERNAME_EMPTY,
        USERNAME_TAKEN, read,
    },
    moves::Sequence,
    topics::KinovaTopics,
};

/// `ConfigurationNotificationEvent`.
const DELETED: u32 = 2;
const CREATED: u32 = 4;

#[derive(Default)]
pub(super) struct StoredEntity {
    users: EntityStore,
    zones: EntityStore,
}

impl StoredEntity {
    pub(super) fn answer(
        &mut self,
        rpc: Rpc,
        payload: &[u8],
        sequences: &mut EntityStore,
        topics: &mut KinovaTopics,
    ) -> AnswerPayload {
        let handle = match rpc {
            READ_USER => return self.users.get(payload),
            READ_USERS => return Ok(self.users.all()),
            READ_ZONE => return self.zones.get(payload),
            READ_ZONES => return Ok(self.zones.all()),
            CREATE_USER => self.create_user(payload)?,
            DELETE_USER => self.users.delete(payload)?,
            CREATE_ZONE => {
                read::<()>(payload)?;
                self.zones.create(payload.to_vec())?
            }
            DELETE_ZONE => self.zones.delete(payload)?,
            CREATE_SEQUENCE => {
                read::<Sequence>(payload)?;
                sequences.create(payload.to_vec())?
            }
            DELETE_SEQUENCE => sequences.delete(payload)?,
            _ => return Err(UNSUPPORTED_METHOD),
        };
        let created = matches!(rpc, CREATE_USER | CREATE_ZONE | CREATE_SEQUENCE);
        let report = |calls: [Rpc; 2]| calls.contains(&rpc).then_some(handle);
        let change = ConfigurationChange {
            event: if created { CREATED } else { DELETED },
            sequence: report([CREATE_SEQUENCE, DELETE_SEQUENCE]),
            user: report([CREATE_USER, DELETE_USER]),
            zone: report([CREATE_ZONE, DELETE_ZONE]),
        };
        topics.report(CONFIGURATION_TOPIC, &change);
        Ok(if created { handle.encode_to_vec() } else { Vec::new() })
    }

    fn create_user(&mut self, payload: &[u8]) -> Result<EntityHandle, InterfaceError> {
        let profile = read::<NewUser>(payload)?.profile;
        let name = read::<User>(&profile)?.name;
        if name.is_empty() {
            return Err(USERNAME_EMPTY);
        }
        if self.users.entries().any(|kept| read::<User>(kept).is_ok_and(|user| user.name == name)) {
            return Err(USERNAME_TAKEN);
        }
        self.users.create(profile)
    }
}
