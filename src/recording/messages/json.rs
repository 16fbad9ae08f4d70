//! Messages in JSON with a JSON schema, for data with more variants than a fixed form can hold.

use crate::session::Encoding;

/// Returns the encoding of a channel of JSON messages with this name and JSON schema.
///
/// ```
/// use nima_recording::messages::json_encoding;
/// assert_eq!(json_encoding("nima.Thing", r#"{"type":"object"}"#).message_encoding, "json");
/// ```
pub fn json_encoding(name: &str, schema: &str) -> Encoding {
    Encoding {
        schema: name.into(),
        schema_encoding: "jsonschema".into(),
        schema_data: schema.into(),
        message_encoding: "json".into(),
    }
}
