//! The emulated omega.7 at the other end of the stub library's socket.
//!
//! A program that loads the stub library (our driver, or a third-party client) sends its requests here, one datagram
//! for one USB exchange. The hand that holds the handle is a [`ForceDimensionBody`]: it receives the motors' output and returns the
//! pose of the handle.

mod firmware;
pub(super) mod standalone;
#[cfg(test)]
#[expect(clippy::float_cmp, reason = "forces and positions arrive unchanged, to the last bit")]
mod tests;

use std::{io, path::PathBuf};

use drd::wire::{ClientOrder, DeviceReply, DeviceRequest, FRESH, SATURATED, TAKEN};
use firmware::Firmware;
use nalgebra::{UnitQuaternion, Vector3};
use nima_devices::force_dimension::status::{ForceDimensionKind, ForceOffCause, SdkError};

pub use firmware::{FirmwareMode, MotorOutput};

use crate::emulators::{EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer, wires::udp};

/// Pose of the handle, in the device's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandState {
    pub position_m: Vector3<f64>,
    pub orientation: UnitQuaternion<f64>,
    /// Opening of the gripper, rad.
    pub gripper_rad: f64,
    /// Buttons, the first in the lowest bit.
    pub buttons: u32,
    /// Whether the force button on the base is pressed.
    pub force_button: bool,
}

impl Default for HandState {
    fn default() -> Self {
        Self {
            position_m: Vector3::zeros(),
            orientation: UnitQuaternion::identity(),
            gripper_rad: 0.0,
            buttons: 0,
            force_button: false,
        }
    }
}

/// The hand: called with the time since the start (s) and the motors' output, about once per millisecond.
pub trait ForceDimensionBody: FnMut(f64, &MotorOutput) -> HandState + Send + 'static {}

impl<T: FnMut(f64, &MotorOutput) -> HandState + Send + 'static> ForceDimensionBody for T {}

/// A hand that moves slowly on its own path and yields to force like a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmulatedHand {
    /// Rest position, m.
    pub rest_m: Vector3<f64>,
    /// Radius of its circular path, m; one turn takes four seconds.
    pub radius_m: f64,
    /// Rotation about the device's z, rad.
    pub yaw_rad: f64,
    /// Opening of the gripper, rad.
    pub gripper_rad: f64,
    /// Stiffness of its grip, N/m.
    pub stiffness_n_m: f64,
}

impl Default for EmulatedHand {
    fn default() -> Self {
        Self {
            rest_m: Vector3::new(0.0, 0.0, 0.02),
            radius_m: 0.02,
            yaw_rad: 0.0,
            gripper_rad: 0.2,
            stiffness_n_m: 500.0,
        }
    }
}

/// Time constant with which a held handle yields, s.
const GIVE_S: f64 = 0.010;

impl EmulatedHand {
    pub fn body(self) -> impl ForceDimensionBody {
        let mut last_s = 0.0;
        let mut given_m = Vector3::zeros();
        move |now_s: f64, applied: &MotorOutput| {
            let fraction = ((now_s - last_s) / GIVE_S).clamp(0.0, 1.0);
            last_s = now_s;
            given_m += (applied.force_n / self.stiffness_n_m - given_m) * fraction;
            let angle = now_s * std::f64::consts::FRAC_PI_2;
            let travel_m = Vector3::new(angle.cos(), angle.sin(), 0.5 * (2.0 * angle).sin()) * self.radius_m;
            // Yaw and gripper move with the hand, by an amount that goes to zero with the radius.
            let wave = (angle * 0.5).sin() * (self.radius_m / 0.02).min(1.0);
            HandState {
                position_m: self.rest_m + travel_m + given_m,
                orientation: UnitQuaternion::from_euler_angles(0.0, 0.0, self.yaw_rad + 0.3 * wave),
                gripper_rad: self.gripper_rad + 0.1 * wave,
                ..HandState::default()
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmulatedForceDimension {
    pub serial: u16,
    /// Right or left hand; our driver refuses any other kind of device.
    pub kind: ForceDimensionKind,
    /// Force beyond which the motors are saturated, N.
    pub motor_limit_n: f64,
    /// Whether the device waits for its calibration.
    pub reset: bool,
    /// UDP port; 0 selects a free one.
    pub port: u16,
}

impl Default for EmulatedForceDimension {
    fn default() -> Self {
        let kind = ForceDimensionKind::Omega7 { left_handed: false };
        Self { serial: 1234, kind, motor_limit_n: nima_devices::force_dimension::FORCE_MAX_N, reset: false, port: 0 }
    }
}

/// A client that is silent for this long loses the device, s.
const SESSION_S: f64 = 1.0;
const FIRMWARE: f64 = 3.2;
/// The gripper counts as pressed below this, rad.
const GRIPPER_CLOSED_RAD: f64 = 0.02;

impl EmulatedForceDimension {
    /// Creates a device held by this hand. The endpoint is the address for `NIMA_EMULATED_HANDLE`.
    pub fn with(self, body: impl ForceDimensionBody) -> Box<dyn Emulator> {
        Box::new(ForceDimensionMachine::new(self, Box::new(body), None))
    }
}

struct ForceDimensionMachine {
    of: EmulatedForceDimension,
    body: Box<dyn ForceDimensionBody>,
    /// Path of the stub library, reported with the endpoint.
    library: Option<PathBuf>,
    firmware: Firmware,
    state: HandState,
    /// State that clients see while the device is frozen.
    frozen: Option<HandState>,
    client: Option<(u64, f64)>,
    pressed: bool,
}

impl ForceDimensionMachine {
    fn new(of: EmulatedForceDimension, mut body: Box<dyn ForceDimensionBody>, library: Option<PathBuf>) -> Self {
        let firmware = Firmware::new(of.motor_limit_n);
        let state = body(0.0, firmware.applied());
        Self { of, body, library, firmware, state, frozen: None, client: None, pressed: false }
    }

    /// Advances the world.
    fn tick(&mut self, now_s: f64, fault: EmulatedFault) {
        self.state = (self.body)(now_s, self.firmware.applied());
        self.firmware.pass(now_s, &self.state.position_m);
        // The button on the base switches force off and on again.
        if self.state.force_button && !self.pressed && self.firmware.applied().mode == FirmwareMode::Force {
            self.firmware.cut(ForceOffCause::Button);
        }
        self.pressed = self.state.force_button;
        self.frozen = (fault == EmulatedFault::Freeze).then(|| self.frozen.unwrap_or(self.state));
        if self.client.is_some_and(|(_, received_s)| now_s - received_s > SESSION_S) {
            self.lose_client();
        }
    }

    const fn lose_client(&mut self) {
        if self.client.is_some() {
            self.client = None;
            self.firmware.cut(ForceOffCause::Usb);
        }
    }

    fn reply(&mut self, now_s: f64, request: &DeviceRequest, fault: EmulatedFault) -> DeviceReply {
        let taken = self.client.is_some_and(|(client, _)| client != request.client);
        let mut flags = if taken { TAKEN } else { 0 };
        let refused = match request.order {
            ClientOrder::Hello => None,
            _ if taken => Some(SdkError::IN_USE),
            ClientOrder::Open => {
                self.client = Some((request.client, now_s));
                None
            }
            _ if self.client.is_none() => Some(SdkError::NO_DEVICE),
            order => {
                self.client = Some((request.client, now_s)).filter(|_| order != ClientOrder::Close);
                if self.firmware.obey(now_s, order, request.argument, request.values) {
                    flags |= SATURATED;
                }
                None
            }
        };
        if self.frozen.is_none() {
            flags |= FRESH;
        }
        self.state_of(request, refused.map_or(0, |error| error.0.cast_unsigned()), flags, fault)
    }

    fn state_of(&self, request: &DeviceRequest, error: u32, flags: u32, fault: EmulatedFault) -> DeviceReply {
        let state = self.frozen.as_ref().unwrap_or(&self.state);
        let mut position_m: [f64; 3] = state.position_m.into();
        if fault == EmulatedFault::NotANumber {
            position_m[1] = f64::NAN;
        }
        let rotation = state.orientation.to_rotation_matrix();
        let frame = std::array::from_fn(|index| rotation.matrix()[(index / 3, index % 3)]);
        let left = self.of.kind == ForceDimensionKind::Omega7 { left_handed: true };
        let pressed = self.firmware.gripper_button && state.gripper_rad < GRIPPER_CLOSED_RAD;
        DeviceReply {
            client: request.client,
            sequence: request.sequence,
            error,
            flags,
            serial: u32::from(self.of.serial),
            kind: self.of.kind.number().cast_unsigned(),
            buttons: state.buttons | u32::from(pressed),
            velocity_threshold: self.firmware.threshold_mm_s,
            watchdog: self.firmware.watchdog_steps,
            status: self.firmware.status(fault == EmulatedFault::DeviceFault, self.of.reset),
            firmware: FIRMWARE,
            position_m,
            frame,
            gripper_rad: if left { -state.gripper_rad } else { state.gripper_rad },
        }
    }
}

impl Emulator for ForceDimensionMachine {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![udp(self.of.port)])
    }

    fn endpoint(&self, places: &[String]) -> String {
        match &self.library {
            Some(library) => format!("{} library={}", places[0], library.display()),
            None => places[0].clone(),
        }
    }

    /// Runs at the priority of a real device, which has its own processor.
    fn begin(&mut self) {
        nima_devices::force_dimension::prepare_thread();
    }

    fn receive(&mut self, from: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        let Some(request) = DeviceRequest::decode(bytes) else { return };
        self.tick(turn.now_s, turn.fault);
        let mut frame = self.reply(turn.now_s, &request, turn.fault).encode().to_vec();
        match turn.fault {
            EmulatedFault::BadChecksum => frame.iter_mut().rev().take(1).for_each(|byte| *byte ^= 0x5a),
            EmulatedFault::WrongFrame => frame.truncate(frame.len() / 2),
            _ => {}
        }
        turn.send(from, &frame);
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        self.tick(turn.now_s, turn.fault);
    }

    fn lose(&mut self, _: WirePeer) {
        self.lose_client();
    }
}

/// Finds the stub library next to the running program, or one folder up, where cargo puts it.
pub fn stand_in() -> Option<std::path::PathBuf> {
    let name = format!("{}drd{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let program = std::env::current_exe().ok()?;
    let folders = program.ancestors().skip(1).take(2);
    folders.flat_map(|folder| [folder.join(&name), folder.join("deps").join(&name)]).find(|path| path.is_file())
}
