//! The law of one contact point: a spring and a damper that never pull, and Coulomb friction through a spring that
//! sticks until the limit (Cundall and Strack, Géotechnique 29, 1979).

use nalgebra::Vector3;

/// Maximum force of one contact, N: an arm driven into or through a peg gets no more.
const FORCE_MAX_N: f64 = 30.0;
/// Stiffness of the friction spring relative to the normal one: 2/3 for rubber (Mindlin, J. Appl. Mech. 16, 1949).
const TANGENTIAL: f64 = 2.0 / 3.0;
/// Damping of the torsion, s times its stiffness: a ring between two fingers rotates at about 40 Hz, and this damps it
/// within a few periods.
const TORSION_S: f64 = 3e-3;

/// Stiffness, damping and friction of a kind of contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Law {
    pub stiffness_n_m: f64,
    pub damping_n_s_m: f64,
    pub friction: f64,
    /// Effective radius of the patch for torsion, m; 0 for none.
    pub patch_radius_m: f64,
}

/// State of a contact while it lasts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactMemory {
    /// Elongation of the friction spring, m.
    stretched_m: Vector3<f64>,
    twisted_rad: f64,
}

/// Geometry of a contact. The normal points from the other body to this one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactTouch {
    pub depth_m: f64,
    pub normal: Vector3<f64>,
    /// Velocity of this body relative to the other, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Rotation relative to the other body about the normal, rad/s.
    pub spin_rad_s: f64,
}

/// Force and torque of the other body on this one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactPush {
    pub force_n: Vector3<f64>,
    /// About the normal, as a vector, N m.
    pub torque_nm: Vector3<f64>,
    /// The part along the normal, N.
    pub normal_n: f64,
}

impl Law {
    /// Returns the forces at the end of a step of `step_s`.
    pub(crate) fn push(&self, memory: &mut ContactMemory, touch: &ContactTouch, step_s: f64) -> ContactPush {
        let approach_m_s = touch.normal.dot(&touch.velocity_m_s);
        // The damper alone would pull while the bodies separate.
        let normal_n = (self.stiffness_n_m * touch.depth_m - self.damping_n_s_m * approach_m_s).clamp(0.0, FORCE_MAX_N);
        let tangent = |vector: &Vector3<f64>| vector - touch.normal * touch.normal.dot(vector);
        let slide_m_s = tangent(&touch.velocity_m_s);
        let stiffness_n_m = self.stiffness_n_m * TANGENTIAL;
        let stretched_m = tangent(&memory.stretched_m) + slide_m_s * step_s;
        let limit_n = self.friction * normal_n;
        let asked_n = -stretched_m * stiffness_n_m - slide_m_s * (self.damping_n_s_m * TANGENTIAL);
        let size_n = asked_n.norm();
        let friction_n = if size_n > limit_n {
            let sliding_n = asked_n * (limit_n / size_n);
            // The spring is shortened to the limit, so that friction reverses as soon as the motion does.
            memory.stretched_m = -sliding_n / stiffness_n_m;
            sliding_n
        } else {
            memory.stretched_m = stretched_m;
            asked_n
        };
        let torque_nm = self.torsion_nm(memory, touch.spin_rad_s, limit_n, step_s);
        ContactPush { force_n: touch.normal * normal_n + friction_n, torque_nm: touch.normal * torque_nm, normal_n }
    }

    fn torsion_nm(&self, memory: &mut ContactMemory, spin_rad_s: f64, limit_n: f64, step_s: f64) -> f64 {
        if self.patch_radius_m <= 0.0 {
            return 0.0;
        }
        let stiffness = self.stiffness_n_m * TANGENTIAL * self.patch_radius_m * self.patch_radius_m;
        let limit_nm = limit_n * self.patch_radius_m;
        memory.twisted_rad += spin_rad_s * step_s;
        let asked_nm = -stiffness * (memory.twisted_rad + TORSION_S * spin_rad_s);
        if asked_nm.abs() <= limit_nm {
            return asked_nm;
        }
        let sliding_nm = limit_nm.copysign(asked_nm);
        memory.twisted_rad = -sliding_nm / stiffness;
        sliding_nm
    }
}

/// Up to two contacts of a ring with one capsule, distinguished by their positions on the ring.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactPair {
    places: [Option<(Vector3<f64>, ContactMemory)>; 2],
}

/// A contact farther than this on the ring is a different one, m.
const MOVED_M: f64 = 3e-3;

impl ContactPair {
    /// Returns the states of the contacts at these positions (in the frame of the ring), in order; all others are
    /// discarded.
    pub(crate) fn of(&mut self, position_m: [Option<Vector3<f64>>; 2]) -> [ContactMemory; 2] {
        let mut left = self.places;
        position_m.map(|position_m| {
            let Some(position_m) = position_m else { return ContactMemory::default() };
            let distance_m = |place: &Option<(Vector3<f64>, ContactMemory)>| {
                place.map_or(f64::INFINITY, |(before_m, _)| (before_m - position_m).norm())
            };
            let nearer = usize::from(distance_m(&left[1]) < distance_m(&left[0]));
            if distance_m(&left[nearer]) < MOVED_M {
                // Taken, so that no two contacts share a state.
                left[nearer].take().map_or_else(ContactMemory::default, |(_, memory)| memory)
            } else {
                ContactMemory::default()
            }
        })
    }

    pub(crate) const fn keep(&mut self, place: usize, position_m: Vector3<f64>, memory: ContactMemory) {
        self.places[place] = Some((position_m, memory));
    }

    pub(crate) const fn forget(&mut self) {
        self.places = [None; 2];
    }
}

impl ContactPush {
    /// Returns the reaction on the other body.
    pub(crate) fn reverse(&self) -> Self {
        Self { force_n: -self.force_n, torque_nm: -self.torque_nm, normal_n: self.normal_n }
    }
}
