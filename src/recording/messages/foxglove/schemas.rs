//! All fields of the messages in the package `foxglove`, as listed on docs.foxglove.dev, so that a reader finds empty
//! lists where we write nothing.

/// Type of a field.
#[derive(Clone, Copy)]
pub(super) enum Holds {
    Double,
    Bool,
    Text,
    Bytes,
    Fixed32,
    /// An enumeration of the message itself.
    Own(&'static str),
    /// Another message of the package.
    Message(&'static str),
    /// A message of the package `google.protobuf`.
    Google(&'static str),
}

/// Name, number, type, and whether it is repeated.
pub(super) type Field = (&'static str, i32, Holds, bool);

pub(super) struct Schema {
    pub(super) name: &'static str,
    pub(super) fields: &'static [Field],
    /// An inner enumeration: its name and values, from 0.
    pub(super) choices: Option<(&'static str, &'static [&'static str])>,
}

use Holds::{Bool, Bytes, Double, Fixed32, Google, Message, Own, Text};

const fn one(name: &'static str, number: i32, holds: Holds) -> Field {
    (name, number, holds, false)
}

const fn many(name: &'static str, number: i32, holds: Holds) -> Field {
    (name, number, holds, true)
}

const fn plain(name: &'static str, fields: &'static [Field]) -> Schema {
    Schema { name, fields, choices: None }
}

const STAMP: Holds = Google("Timestamp");
const POSE: Field = one("pose", 1, Message("Pose"));
const SIZE: Field = one("size", 2, Message("Vector3"));
const XYZ: [Field; 3] = [one("x", 1, Double), one("y", 2, Double), one("z", 3, Double)];

pub(super) const SCHEMAS: &[Schema] = &[
    plain("Vector3", &XYZ),
    plain("Point3", &XYZ),
    plain("Quaternion", &[XYZ[0], XYZ[1], XYZ[2], one("w", 4, Double)]),
    plain("Color", &[one("r", 1, Double), one("g", 2, Double), one("b", 3, Double), one("a", 4, Double)]),
    plain("KeyValuePair", &[one("key", 1, Text), one("value", 2, Text)]),
    plain("Pose", &[one("position", 1, Message("Vector3")), one("orientation", 2, Message("Quaternion"))]),
    plain(
        "FrameTransform",
        &[
            one("timestamp", 1, STAMP),
            one("parent_frame_id", 2, Text),
            one("child_frame_id", 3, Text),
            one("translation", 4, Message("Vector3")),
            one("rotation", 5, Message("Quaternion")),
        ],
    ),
    plain("FrameTransforms", &[many("transforms", 1, Message("FrameTransform"))]),
    plain(
        "CompressedImage",
        &[one("timestamp", 1, STAMP), one("data", 2, Bytes), one("format", 3, Text), one("frame_id", 4, Text)],
    ),
    plain(
        "CompressedVideo",
        &[one("timestamp", 1, STAMP), one("frame_id", 2, Text), one("data", 3, Bytes), one("format", 4, Text)],
    ),
    Schema {
        name: "Log",
        fields: &[
            one("timestamp", 1, STAMP),
            one("level", 2, Own("Level")),
            one("message", 3, Text),
            one("name", 4, Text),
            one("file", 5, Text),
            one("line", 6, Fixed32),
        ],
        choices: Some(("Level", &["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"])),
    },
    plain(
        "ArrowPrimitive",
        &[
            POSE,
            one("shaft_length", 2, Double),
            one("shaft_diameter", 3, Double),
            one("head_length", 4, Double),
            one("head_diameter", 5, Double),
            one("color", 6, Message("Color")),
        ],
    ),
    plain("CubePrimitive", &[POSE, SIZE, one("color", 3, Message("Color"))]),
    plain("SpherePrimitive", &[POSE, SIZE, one("color", 3, Message("Color"))]),
    plain(
        "CylinderPrimitive",
        &[POSE, SIZE, one("bottom_scale", 3, Double), one("top_scale", 4, Double), one("color", 5, Message("Color"))],
    ),
    Schema {
        name: "LinePrimitive",
        fields: &[
            one("type", 1, Own("Type")),
            one("pose", 2, Message("Pose")),
            one("thickness", 3, Double),
            one("scale_invariant", 4, Bool),
            many("points", 5, Message("Point3")),
            one("color", 6, Message("Color")),
            many("colors", 7, Message("Color")),
            many("indices", 8, Fixed32),
        ],
        choices: Some(("Type", &["LINE_STRIP", "LINE_LOOP", "LINE_LIST"])),
    },
    plain(
        "TriangleListPrimitive",
        &[
            POSE,
            many("points", 2, Message("Point3")),
            one("color", 3, Message("Color")),
            many("colors", 4, Message("Color")),
            many("indices", 5, Fixed32),
        ],
    ),
    plain(
        "TextPrimitive",
        &[
            POSE,
            one("billboard", 2, Bool),
            one("font_size", 3, Double),
            one("scale_invariant", 4, Bool),
            one("color", 5, Message("Color")),
            one("text", 6, Text),
        ],
    ),
    plain(
        "ModelPrimitive",
        &[
            POSE,
            one("scale", 2, Message("Vector3")),
            one("color", 3, Message("Color")),
            one("override_color", 4, Bool),
            one("url", 5, Text),
            one("media_type", 6, Text),
            one("data", 7, Bytes),
        ],
    ),
    plain(
        "SceneEntity",
        &[
            one("timestamp", 1, STAMP),
            one("frame_id", 2, Text),
            one("id", 3, Text),
            one("lifetime", 4, Google("Duration")),
            one("frame_locked", 5, Bool),
            many("metadata", 6, Message("KeyValuePair")),
            many("arrows", 7, Message("ArrowPrimitive")),
            many("cubes", 8, Message("CubePrimitive")),
            many("spheres", 9, Message("SpherePrimitive")),
            many("cylinders", 10, Message("CylinderPrimitive")),
            many("lines", 11, Message("LinePrimitive")),
            many("triangles", 12, Message("TriangleListPrimitive")),
            many("texts", 13, Message("TextPrimitive")),
            many("models", 14, Message("ModelPrimitive")),
        ],
    ),
    Schema {
        name: "SceneEntityDeletion",
        fields: &[one("timestamp", 1, STAMP), one("type", 2, Own("Type")), one("id", 3, Text)],
        choices: Some(("Type", &["MATCHING_ID", "ALL"])),
    },
    plain(
        "SceneUpdate",
        &[many("deletions", 1, Message("SceneEntityDeletion")), many("entities", 2, Message("SceneEntity"))],
    ),
];
