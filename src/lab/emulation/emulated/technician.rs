//! The simulated technician at the emulated arm of one side: follows the instructions on the screen, with the flaws of
//! [`Person`].
//!
//! Takes the content of the screen; guides the joints (rad) by hand, pushes, and removes body wall and tissue where a
//! calibration needs it. All actions reach the loop through the devices: the arm's joints move, the sensors measure the
//! hands. The technician never guides an arm whose drives are on.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::kinematics::{Arm, Joints};
use nima_machine::rig::Prompt;

use nima_simulation::{
    HandForces, Person,
    scene::{PersonModel as PersonConfig, Scene},
    screen::PersonTask,
};

use super::guiding::{Guide, ToolHold, nearest_turn};

/// The shaft counts as in the trocar if its axis passes the trocar within this distance, m.
const IN_TROCAR_M: f64 = 1e-3;
/// Time for carrying the arm: seconds per radian of the joint that rotates most, and the minimum.
const CARRY_S_PER_RAD: f64 = 1.7;
const CARRY_MIN_S: f64 = 0.8;
/// If a hold is missed by this much, m at the tip's lever, for longer than [`STUCK_S`], another pose is tried.
const STUCK_M: f64 = 0.03;
/// If such a miss lasts this long, s, the pose cannot be reached by rotating further.
const STUCK_S: f64 = 1.0;
/// Number of poses considered before choosing one that the arm may not reach. The first one that the arm reaches is
/// taken, so that a session does not wait for a pose that is out of reach.
const CHOICES: usize = 10;
/// Height of the tip before poses in free space, touches and moves, m. High enough that neither the tissue nor the wall
/// is touched, because a touched pose is refused.
const ABOVE_M: f64 = 0.05;

/// The technician as seen by this side.
#[derive(Clone, Debug)]
pub(super) struct SideTechnician {
    arm: Arm,
    guide: Guide,
    ready_rad: Joints,
    config: PersonConfig,
    scene: Scene,
    /// Orientation of the endoscope image.
    world_from_view: UnitQuaternion<f64>,
    task: PersonTask,
    prompt: Prompt,
    doing: TechnicianActivity,
    stuck_s: f64,
    /// Number of visits, so that no two sessions are alike.
    visits: u64,
}

#[derive(Clone, Debug)]
enum TechnicianActivity {
    /// Not at this arm, which stays where it was left.
    Away,
    /// Called, about to take hold of the arm.
    Called,
    /// Carrying the arm.
    Carrying(Carry),
    /// Following the instructions.
    AtWork(Box<Person>),
    /// Interrupting the work while the arm takes another pose.
    Reseating(Box<Person>, Carry),
}

#[derive(Clone, Copy, Debug)]
struct Carry {
    from_rad: Joints,
    to_rad: Joints,
    seconds: f64,
    in_s: f64,
}

impl Carry {
    fn new(from_rad: &Joints, to_rad: &Joints) -> Self {
        let seconds = (CARRY_S_PER_RAD * (to_rad - from_rad).amax()).max(CARRY_MIN_S);
        Self { from_rad: *from_rad, to_rad: *to_rad, seconds, in_s: 0.0 }
    }

    /// Advances; returns the joint angles, rad, and whether they have reached their target.
    fn step(&mut self, dt_s: f64) -> (Joints, bool) {
        self.in_s += dt_s;
        let s = (self.in_s / self.seconds).min(1.0);
        let fraction = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        (self.from_rad + (self.to_rad - self.from_rad) * fraction, s >= 1.0)
    }
}

impl SideTechnician {
    /// Creates a technician away from the arm of a scene adapted to its side. `ready_rad` are the joint angles with the
    /// instrument in the trocar.
    pub(super) fn new(arm: &Arm, ready_rad: Joints, scene: &Scene, world_from_view: UnitQuaternion<f64>) -> Self {
        Self {
            arm: *arm,
            guide: Guide::new(arm, ready_rad),
            ready_rad,
            config: scene.person.unwrap_or_default(),
            scene: scene.clone(),
            world_from_view,
            task: PersonTask::Surgery,
            prompt: Prompt::Rest,
            doing: TechnicianActivity::Away,
            stuck_s: 0.0,
            visits: 0,
        }
    }

    pub(super) fn reads(&mut self, task: PersonTask, prompt: Prompt) {
        self.prompt = if prompt.is_finite() { prompt } else { Prompt::Rest };
        if task != self.task {
            self.task = task;
            self.doing = TechnicianActivity::Called;
        }
    }

    /// Returns whether no one is at the arm.
    pub(super) const fn is_away(&self) -> bool {
        matches!(self.doing, TechnicianActivity::Away)
    }

    /// Advances by `dt_s` with the arm at these angles (rad) and its drives off; returns the angles to which the arm is
    /// guided.
    pub(super) fn advance(&mut self, joint_rad: &Joints, dt_s: f64) -> Joints {
        let mut joints = *joint_rad;
        self.doing = match std::mem::replace(&mut self.doing, TechnicianActivity::Away) {
            TechnicianActivity::Away => TechnicianActivity::Away,
            // Do not remove an instrument that is needed in the trocar.
            TechnicianActivity::Called if self.stays_in_trocar() && self.is_in_trocar(joint_rad) => {
                TechnicianActivity::AtWork(Box::new(self.person(joint_rad)))
            }
            TechnicianActivity::Called => {
                TechnicianActivity::Carrying(Carry::new(joint_rad, &self.beginning(joint_rad)))
            }
            TechnicianActivity::Carrying(mut carry) => {
                let (next, done) = carry.step(dt_s);
                joints = next;
                match self.task {
                    _ if !done => TechnicianActivity::Carrying(carry),
                    PersonTask::Surgery => TechnicianActivity::Away,
                    _ => TechnicianActivity::AtWork(Box::new(self.person(&joints))),
                }
            }
            TechnicianActivity::AtWork(person) => self.obey(person, &mut joints, dt_s),
            TechnicianActivity::Reseating(mut person, mut carry) => {
                person.advance(&self.prompt, dt_s);
                let (next, done) = carry.step(dt_s);
                joints = next;
                if done { TechnicianActivity::AtWork(person) } else { TechnicianActivity::Reseating(person, carry) }
            }
        };
        joints
    }

    fn obey(&mut self, mut person: Box<Person>, joints: &mut Joints, dt_s: f64) -> TechnicianActivity {
        person.advance(&self.prompt, dt_s);
        self.let_choose(&mut person, joints);
        let hold = self.hold(&person);
        let miss_m = self.guide.step(joints, &hold, dt_s);
        self.stuck_s = if miss_m > STUCK_M { self.stuck_s + dt_s } else { 0.0 };
        if self.stuck_s > STUCK_S {
            self.stuck_s = 0.0;
            if let Some(other) = self.guide.find(joints, &hold) {
                return TechnicianActivity::Reseating(person, Carry::new(joints, &other));
            }
        }
        TechnicianActivity::AtWork(person)
    }

    /// Rejects a pose that the arm cannot reach from its current one.
    fn let_choose(&self, person: &mut Person, joint_rad: &Joints) {
        for _ in 0..CHOICES {
            let Some((tip_m, world_from_s1)) = person.chosen() else { return };
            if !self.holds_poses() || self.guide.reaches(joint_rad, &ToolHold::Pose { tip_m, world_from_s1 }) {
                return;
            }
            person.choose_again();
        }
    }

    const fn holds_poses(&self) -> bool {
        matches!(self.task, PersonTask::Tip | PersonTask::HandEye)
    }

    const fn stays_in_trocar(&self) -> bool {
        matches!(self.task, PersonTask::TipForce | PersonTask::Trocar)
    }

    fn is_in_trocar(&self, joint_rad: &Joints) -> bool {
        let pose = self.arm.pose(joint_rad);
        let trocar_m = &self.scene.trocar_m;
        pose.insertion_m(trocar_m) > 0.0 && pose.axis_miss_m(trocar_m).norm() < IN_TROCAR_M
    }

    /// Returns a person who starts this task at an arm with these angles, rad.
    fn person(&mut self, joint_rad: &Joints) -> Person {
        self.visits += 1;
        let mut scene = self.scene.clone();
        scene.seed = scene.seed.wrapping_add(self.visits);
        let pose = self.arm.pose(joint_rad);
        if self.stays_in_trocar() {
            return Person::new(self.config, &scene).begins_at(pose.tip_m);
        }
        // The other calibrations are done without the body wall.
        scene.trocar = None;
        let person = Person::new(self.config, &scene);
        match self.task {
            PersonTask::Tip | PersonTask::HandEye | PersonTask::Table | PersonTask::View => {
                person.begins_at(pose.tip_m).turned(pose.orientation(), self.world_from_view)
            }
            _ => person,
        }
    }

    /// Returns the joint angles at the start of the current task.
    fn beginning(&self, from_rad: &Joints) -> Joints {
        let ready_rad = nearest_turn(self.arm.model(), from_rad, &self.ready_rad);
        let down = Vector3::new(0.0, 0.0, 1.0);
        let hold = match self.task {
            PersonTask::Surgery | PersonTask::TipForce | PersonTask::Trocar => return ready_rad,
            PersonTask::Gravity => ToolHold::Tilt(down),
            PersonTask::Correspondence => {
                let person = Person::new(self.config, &Scene { trocar: None, ..self.scene.clone() });
                ToolHold::Tip { tip_m: person.tip().0, along: -down }
            }
            PersonTask::Tip | PersonTask::HandEye | PersonTask::Table | PersonTask::View => {
                ToolHold::Tip { tip_m: down * ABOVE_M, along: -down }
            }
        };
        self.guide.find(from_rad, &hold).unwrap_or(ready_rad)
    }

    fn hold(&self, person: &Person) -> ToolHold {
        let world_from_s1 = person.world_from_s1();
        match self.task {
            PersonTask::Gravity => ToolHold::Tilt(world_from_s1.inverse() * -Vector3::z()),
            PersonTask::Tip | PersonTask::HandEye => ToolHold::Pose { tip_m: person.tip().0, world_from_s1 },
            _ => ToolHold::Tip { tip_m: person.tip().0, along: world_from_s1 * Vector3::z() },
        }
    }

    /// Returns whether body wall and tissue are removed: whenever the arm is moved, and for the calibrations without a
    /// wall. Pushes then replace the tissue on its sensor.
    pub(super) const fn sets_aside(&self) -> bool {
        match self.doing {
            TechnicianActivity::Away => false,
            TechnicianActivity::Called | TechnicianActivity::Carrying(_) | TechnicianActivity::Reseating(..) => true,
            TechnicianActivity::AtWork(_) => !self.stays_in_trocar(),
        }
    }

    /// Returns the offset of the handle from its rest position, m (`world`).
    pub(super) fn handle_m(&self) -> Vector3<f64> {
        match &self.doing {
            TechnicianActivity::AtWork(person) | TechnicianActivity::Reseating(person, _) => person.handle_m(),
            _ => Vector3::zeros(),
        }
    }

    /// Returns the forces of the technician's hands.
    pub(super) fn touch(&self) -> HandForces {
        match &self.doing {
            TechnicianActivity::AtWork(person) | TechnicianActivity::Reseating(person, _) => person.touch(),
            _ => HandForces::default(),
        }
    }
}
