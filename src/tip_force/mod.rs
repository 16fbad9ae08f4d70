//! The force at the tip from what the wrist feels: a small network that takes the trocar's friction out.
//!
//! Takes named columns (wrist force in N, torque in Nm, orientation, motion through the trocar); gives the force at the tip in
//! the frame of the wrist sensor (`s1`, N), and says when it is out of its depth.
