//! The chain of an arm from a URDF file: its moving joints between two links. Shapes, masses and meshes are not read.
//!
//! Lengths in m, angles in rad, as URDF has them.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use nima_core::kinematics::{ArmChain, ChainJoint};
use nima_files::{PASSAGE, shortened};
use roxmltree::{Document, Node};

/// Descriptions round right angles to four or five digits; an angle within this distance of a right angle is exact, rad.
const ROUNDED_RAD: f64 = 1e-5;

/// Reason why a file does not describe a usable arm, with its line where one is to blame.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UrdfError(String);

/// The part of a URDF that is the arm.
#[derive(Clone, Copy, Debug)]
pub struct ChainEnds<'a> {
    pub base_link: &'a str,
    /// Its z must point away from the arm.
    pub flange_link: &'a str,
}

/// Returns the chain between two links of a URDF; every joint gets this acceleration, rad/s^2, which URDF does not have.
///
/// # Errors
/// [`UrdfError`] if the text is not a URDF, the links are not connected by revolute joints in series, or a limit is
/// missing.
pub fn chain_of(text: &str, ends: ChainEnds<'_>, acceleration_rad_s2: f64) -> Result<ArmChain, UrdfError> {
    let document = Document::parse(text).map_err(|error| UrdfError(shortened(&error.to_string(), PASSAGE)))?;
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        return Err(UrdfError("it is not a URDF: its first element is not <robot>".to_owned()));
    }
    let is_xacro = |node: &Node<'_, '_>| node.tag_name().namespace().is_some_and(|name| name.contains("xacro"));
    if let Some(node) = robot.descendants().find(is_xacro) {
        return Err(at(&node, "this is a xacro file: convert it with `xacro FILE.xacro > FILE.urdf`"));
    }
    let joints = robot.children().filter(|node| node.has_tag_name("joint")).map(UrdfJoint::of);
    let joints = joints.collect::<Result<Vec<_>, _>>()?;
    let path = path_of(&joints, ends)?;
    let mut chain = ArmChain { joints: Vec::new(), last_from_flange: Isometry3::identity() };
    for joint in path {
        // Fixed joints belong to the next moving one.
        chain.last_from_flange *= joint.origin()?;
        if joint.is_fixed() {
            continue;
        }
        let from_previous = std::mem::take(&mut chain.last_from_flange);
        let range_rad = joint.range_rad()?;
        let speed_rad_s = joint.limit("velocity")?;
        chain.joints.push(ChainJoint {
            from_previous,
            axis: joint.axis()?,
            range_rad,
            speed_rad_s,
            acceleration_rad_s2,
        });
    }
    Ok(chain)
}

/// A joint of the file.
struct UrdfJoint<'a> {
    node: Node<'a, 'a>,
    kind: &'a str,
    parent: &'a str,
    child: &'a str,
}

/// Returns the joints from base to flange, in this order.
fn path_of<'a, 'j>(joints: &'j [UrdfJoint<'a>], ends: ChainEnds<'_>) -> Result<Vec<&'j UrdfJoint<'a>>, UrdfError> {
    let ChainEnds { base_link, flange_link } = ends;
    let known = |link: &str| joints.iter().any(|joint| joint.parent == link || joint.child == link);
    for (key, link) in [("base_link", base_link), ("flange_link", flange_link)] {
        if !known(link) {
            return Err(UrdfError(format!("no joint has the link {link:?}: correct {key} in the rig file")));
        }
    }
    let mut path = Vec::new();
    let mut link = flange_link;
    while link != base_link {
        let mut above = joints.iter().filter(|joint| joint.child == link);
        let Some(joint) = above.next() else {
            return Err(UrdfError(format!("the link {flange_link:?} is not beyond {base_link:?}: correct the links")));
        };
        if let Some(other) = above.next() {
            return Err(at(&other.node, &format!("the link {link:?} has two joints above it")));
        }
        if path.len() == joints.len() {
            return Err(at(&joint.node, "the joints form a ring"));
        }
        path.push(joint);
        link = joint.parent;
    }
    path.reverse();
    let is_in_path = |joint: &UrdfJoint<'_>| path.iter().any(|own| std::ptr::eq(*own, joint));
    let branches = |joint: &&UrdfJoint<'_>| {
        !joint.is_fixed() && !is_in_path(joint) && path.iter().any(|own| own.parent == joint.parent)
    };
    match joints.iter().find(branches) {
        Some(joint) => {
            Err(joint.wrong("it branches off between base and flange: choose links with one arm between them"))
        }
        None => Ok(path),
    }
}

impl<'a> UrdfJoint<'a> {
    fn of(node: Node<'a, 'a>) -> Result<Self, UrdfError> {
        let link = |name| {
            let link = child(node, name).and_then(|node| node.attribute("link"));
            link.ok_or_else(|| at(&node, &format!("a joint without <{name} link=...>")))
        };
        let kind = node.attribute("type").ok_or_else(|| at(&node, "a joint without type"))?;
        Ok(Self { node, kind, parent: link("parent")?, child: link("child")? })
    }

    fn is_fixed(&self) -> bool {
        self.kind == "fixed"
    }

    fn wrong(&self, message: &str) -> UrdfError {
        at(&self.node, &format!("joint {:?}: {message}", self.node.attribute("name").unwrap_or_default()))
    }

    /// Returns its pose in the frame of the joint before.
    fn origin(&self) -> Result<Isometry3<f64>, UrdfError> {
        let Some(origin) = child(self.node, "origin") else { return Ok(Isometry3::identity()) };
        if origin.has_attribute("quat_xyzw") {
            return Err(self.wrong("its origin is given by a quaternion: use rpy"));
        }
        let shift_m = self.three(origin, "xyz", Vector3::zeros())?;
        let [roll, pitch, yaw] = self.three(origin, "rpy", Vector3::zeros())?.map(exact).into();
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Ok(Isometry3::from_parts(Translation3::from(shift_m), rotation))
    }

    fn axis(&self) -> Result<Vector3<f64>, UrdfError> {
        child(self.node, "axis").map_or(Ok(Vector3::x()), |axis| self.three(axis, "xyz", Vector3::x()))
    }

    fn range_rad(&self) -> Result<[f64; 2], UrdfError> {
        if child(self.node, "mimic").is_some() {
            return Err(self.wrong("it follows another joint: an arm needs joints with drives"));
        }
        match self.kind {
            "continuous" => Ok([f64::NEG_INFINITY, f64::INFINITY]),
            "revolute" => Ok([self.limit("lower")?, self.limit("upper")?]),
            other => Err(self.wrong(&format!("it is {other}: an arm needs revolute or continuous joints"))),
        }
    }

    fn limit(&self, key: &str) -> Result<f64, UrdfError> {
        let text = child(self.node, "limit").and_then(|limit| limit.attribute(key));
        let text = text.ok_or_else(|| self.wrong(&format!("its limit {key} is missing: enter it")))?;
        self.number(text)
    }

    fn number(&self, text: &str) -> Result<f64, UrdfError> {
        let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| self.wrong(&format!("{:?} is not a number", shortened(text, PASSAGE))))
    }

    fn three(&self, node: Node<'_, '_>, key: &str, usual: Vector3<f64>) -> Result<Vector3<f64>, UrdfError> {
        let Some(text) = node.attribute(key) else { return Ok(usual) };
        let numbers = text.split_whitespace().map(|word| self.number(word)).collect::<Result<Vec<_>, _>>()?;
        let three = <[f64; 3]>::try_from(numbers).map_err(|_| self.wrong(&format!("{key} needs three numbers")))?;
        Ok(three.into())
    }
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn at(node: &Node<'_, '_>, message: &str) -> UrdfError {
    let line = node.document().text_pos_at(node.range().start).row;
    UrdfError(format!("line {line}: {message}"))
}

/// Returns the right angle of which this angle is the rounded value, else the angle.
fn exact(angle_rad: f64) -> f64 {
    let right_rad = (angle_rad / FRAC_PI_2).round() * FRAC_PI_2;
    if (angle_rad - right_rad).abs() < ROUNDED_RAD { right_rad } else { angle_rad }
}

#[cfg(test)]
#[path = "urdf_tests.rs"]
mod tests;
