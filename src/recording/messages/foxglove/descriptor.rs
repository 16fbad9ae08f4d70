//! Descriptions of messages in Protocol Buffers' own form: a set of files, each after the files that it needs.
//!
//! The few required parts of `google/protobuf/descriptor.proto` are written by hand, which costs less than a
//! dependency.

use prost::Message;

use super::schemas::{Holds, SCHEMAS, Schema};

#[derive(Clone, PartialEq, Message)]
pub(super) struct FileSet {
    #[prost(message, repeated, tag = "1")]
    file: Vec<File>,
}

#[derive(Clone, PartialEq, Message)]
struct File {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(string, tag = "2")]
    package: String,
    #[prost(string, repeated, tag = "3")]
    dependency: Vec<String>,
    #[prost(message, repeated, tag = "4")]
    message_type: Vec<Description>,
    #[prost(string, tag = "12")]
    syntax: String,
}

#[derive(Clone, PartialEq, Message)]
struct Description {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, repeated, tag = "2")]
    field: Vec<Field>,
    #[prost(message, repeated, tag = "4")]
    enum_type: Vec<Choices>,
}

#[derive(Clone, PartialEq, Message)]
struct Field {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(int32, tag = "3")]
    number: i32,
    #[prost(int32, tag = "4")]
    label: i32,
    #[prost(int32, tag = "5")]
    kind: i32,
    #[prost(string, optional, tag = "6")]
    type_name: Option<String>,
}

#[derive(Clone, PartialEq, Message)]
struct Choices {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, repeated, tag = "2")]
    value: Vec<Choice>,
}

#[derive(Clone, PartialEq, Message)]
struct Choice {
    #[prost(string, tag = "1")]
    name: String,
    // An explicit presence, so that the value 0 is written too.
    #[prost(int32, optional, tag = "2")]
    number: Option<i32>,
}

const LABEL_ONE: i32 = 1;
const LABEL_MANY: i32 = 3;
const KIND_INT64: i32 = 3;
const KIND_INT32: i32 = 5;

/// Returns the description of this message of the package and of all messages that it contains.
pub(super) fn file_set(name: &str) -> FileSet {
    let mut set = FileSet { file: Vec::new() };
    add(&mut set, name);
    set
}

fn add(set: &mut FileSet, name: &str) {
    let Some(schema) = SCHEMAS.iter().find(|schema| schema.name == name) else { return };
    let mut dependency: Vec<String> = Vec::new();
    for &(.., holds, _) in schema.fields {
        let file = match holds {
            Holds::Message(other) => {
                add(set, other);
                file_name(other)
            }
            Holds::Google(other) => add_google(set, other),
            _ => continue,
        };
        if !dependency.contains(&file) {
            dependency.push(file);
        }
    }
    add_file(set, file_name(name), "foxglove", dependency, description(schema));
}

fn file_name(name: &str) -> String {
    format!("foxglove/{name}.proto")
}

/// Adds `Timestamp` or `Duration`, which have the same fields.
fn add_google(set: &mut FileSet, name: &str) -> String {
    let file = format!("google/protobuf/{}.proto", name.to_lowercase());
    let field =
        |name: &str, number, kind| Field { name: name.to_owned(), number, label: LABEL_ONE, kind, type_name: None };
    let fields = vec![field("seconds", 1, KIND_INT64), field("nanos", 2, KIND_INT32)];
    let message = Description { name: name.to_owned(), field: fields, enum_type: Vec::new() };
    add_file(set, file.clone(), "google.protobuf", Vec::new(), message);
    file
}

fn add_file(set: &mut FileSet, name: String, package: &str, dependency: Vec<String>, message: Description) {
    if set.file.iter().all(|file| file.name != name) {
        let package = package.to_owned();
        let syntax = "proto3".to_owned();
        set.file.push(File { name, package, dependency, message_type: vec![message], syntax });
    }
}

fn description(schema: &Schema) -> Description {
    let field = |&(name, number, holds, many): &(&str, i32, Holds, bool)| {
        let (kind, type_name) = match holds {
            Holds::Double => (1, None),
            Holds::Fixed32 => (7, None),
            Holds::Bool => (8, None),
            Holds::Text => (9, None),
            Holds::Message(other) => (11, Some(format!(".foxglove.{other}"))),
            Holds::Google(other) => (11, Some(format!(".google.protobuf.{other}"))),
            Holds::Bytes => (12, None),
            Holds::Own(own) => (14, Some(format!(".foxglove.{}.{own}", schema.name))),
        };
        let label = if many { LABEL_MANY } else { LABEL_ONE };
        Field { name: name.to_owned(), number, label, kind, type_name }
    };
    let choices = schema.choices.map(|(name, values)| Choices {
        name: name.to_owned(),
        value: (0..)
            .zip(values)
            .map(|(number, &name)| Choice { name: name.to_owned(), number: Some(number) })
            .collect(),
    });
    let field = schema.fields.iter().map(field).collect();
    Description { name: schema.name.to_owned(), field, enum_type: choices.into_iter().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_description_is_complete_and_in_order() {
        for schema in SCHEMAS {
            let set = file_set(schema.name);
            let names: Vec<_> = set.file.iter().map(|file| &file.name).collect();
            assert_eq!(*names.last().unwrap(), &file_name(schema.name));
            for (number, file) in set.file.iter().enumerate() {
                assert!(!names[..number].contains(&&file.name), "{} twice", file.name);
                for needed in &file.dependency {
                    assert!(names[..number].contains(&needed), "{} before {needed}", file.name);
                }
            }
        }
        assert_eq!(file_set("SceneUpdate").file.len(), 19, "all but those of frames and logs, and two of others");
    }
}
