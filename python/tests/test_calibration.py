"""Fits of gravity and correspondence: the same as the program's."""

from __future__ import annotations

import numpy as np
import pytest

import nima


def rotations(count: int, seed: int) -> np.ndarray:
    """Unit quaternions w, x, y, z, all over the sphere."""
    wxyz = np.random.default_rng(seed).normal(size=(count, 4))
    return wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True)


def turned(wxyz: np.ndarray, vectors: np.ndarray, inverse: bool = False) -> np.ndarray:
    """The vectors in the other frame."""
    w, axis = wxyz[:, :1], wxyz[:, 1:] * (-1.0 if inverse else 1.0)
    twice = 2.0 * np.cross(axis, vectors)
    return vectors + w * twice + np.cross(axis, twice)


def poses(count: int = 24) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces, torques and orientations of a tool of 0.3 kg."""
    wxyz = rotations(count, 1)
    weight_n = turned(wxyz, np.tile([0.0, 0.0, -0.3 * 9.80665], (count, 1)), inverse=True)
    noise = np.random.default_rng(2).normal(0.0, 0.005, (count, 3))
    return weight_n + [0.4, -0.2, 0.9] + noise, np.cross([0.0, 0.01, 0.08], weight_n) + [0.01, 0.0, -0.02], wxyz


def test_gravity_agrees_with_the_program_to_the_last_bit(program, write):
    forces_n, torques_nm, wxyz = poses()
    force = {f"f{axis}_n": forces_n[:, i] for i, axis in enumerate("xyz")}
    torque = {f"t{axis}_nm": torques_nm[:, i] for i, axis in enumerate("xyz")}
    path = write("poses.csv", **force, **torque, **{f"q{axis}": wxyz[:, i] for i, axis in enumerate("wxyz")})
    report = nima.fit_gravity(forces_n, torques_nm, world_from_sensor_wxyz=wxyz)
    assert report == program.json("calibrate", "gravity", path)
    assert report["verdict"] == "accepted" and abs(report["mass_kg"] - 0.3) < 0.003
    path = write("imu.csv", **force, ax=wxyz[:, 1] * 9.8, ay=wxyz[:, 2] * 9.8, az=9.8 + wxyz[:, 3])
    accelerations = np.stack([wxyz[:, 1] * 9.8, wxyz[:, 2] * 9.8, 9.8 + wxyz[:, 3]], axis=1)
    by_imu = nima.fit_gravity(forces_n, accelerations_m_s2=accelerations, model="physical", flip_imu=True)
    assert by_imu["verdict"] != "accepted", "these accelerations are not those of the poses"


def test_what_is_left_without_gravity_is_the_noise():
    forces_n, torques_nm, wxyz = poses()
    report = nima.fit_gravity(forces_n, torques_nm, world_from_sensor_wxyz=wxyz)
    pushed_n = forces_n + [1.0, 2.0, 3.0]
    free_n, free_nm = nima.remove_gravity(report, pushed_n, torques_nm, world_from_sensor_wxyz=wxyz)
    assert np.allclose(free_n, [1.0, 2.0, 3.0], atol=0.03) and free_nm is not None and np.allclose(free_nm, 0.0, atol=0.005)
    model = next(fit["model"] for fit in report["fits"] if fit["kind"] == "gain")
    alone, none = nima.remove_gravity(model, pushed_n, world_from_sensor_wxyz=wxyz)
    assert none is None and np.allclose(alone, [1.0, 2.0, 3.0], atol=0.05)
    with pytest.raises(ValueError, match="this model needs world_from_sensor_wxyz"):
        nima.remove_gravity(report, pushed_n, accelerations_m_s2=pushed_n)


def test_correspondence_agrees_with_the_program_to_the_last_bit(program, write):
    wxyz = np.tile(rotations(1, 5), (40, 1))
    tissue_n = np.random.default_rng(6).normal(0.0, 2.0, (40, 3))
    wrist_n = turned(wxyz, tissue_n) + np.random.default_rng(7).normal(0.0, 0.02, (40, 3))
    names = {f"f1{axis}_n": wrist_n[:, i] for i, axis in enumerate("xyz")}
    names |= {f"f2{axis}_n": tissue_n[:, i] for i, axis in enumerate("xyz")}
    report = nima.fit_correspondence(wrist_n, tissue_n)
    assert report == program.json("calibrate", "correspondence", write("pairs.csv", **names))
    found = np.array(report["solution"]["rotation_wxyz"])
    assert report["verdict"] == "accepted" and abs(abs(found @ wxyz[0]) - 1.0) < 1e-5
    flipped = nima.fit_correspondence(wrist_n, -tissue_n, flip_tissue=True)
    assert flipped["solution"] == report["solution"]


def test_poor_poses_are_a_verdict_and_impossible_ones_an_error():
    forces_n, _, wxyz = poses(8)
    alike = nima.fit_gravity(np.tile(forces_n[:1], (8, 1)), world_from_sensor_wxyz=np.tile(wxyz[:1], (8, 1)))
    assert alike["verdict"] != "accepted" and alike["reason"]
    for call, words in [
        (lambda: nima.fit_gravity(forces_n), "give either accelerations_m_s2 or world_from_sensor_wxyz"),
        (lambda: nima.fit_gravity(forces_n[:, :2], world_from_sensor_wxyz=wxyz), r"forces_n has the shape \(8, 2\), \(n, 3\) is needed"),
        (lambda: nima.fit_gravity(forces_n, world_from_sensor_wxyz=wxyz[1:]), r"shape \(7, 4\), \(8, 4\) is needed"),
        (lambda: nima.fit_gravity(forces_n, world_from_sensor_wxyz=wxyz * 2.0), "row 0: the quaternion has length 2.000"),
        (lambda: nima.fit_gravity(forces_n * np.nan, world_from_sensor_wxyz=wxyz), "forces_n, row 0: NaN"),
        (lambda: nima.fit_gravity(forces_n, world_from_sensor_wxyz=wxyz, model="magic"), 'model is "magic"; give one of physical'),
        (lambda: nima.fit_gravity(forces_n, accelerations_m_s2=wxyz[:, 1:] * 0.0), "the accelerometer reads 0.00"),
        (lambda: nima.fit_gravity(forces_n[:0], world_from_sensor_wxyz=wxyz[:0]), "no poses were given"),
        (lambda: nima.fit_correspondence(forces_n, forces_n[1:]), r"tissue_forces_n has the shape \(7, 3\)"),
        (lambda: nima.fit_correspondence(forces_n * 1e9, forces_n), "is not a plausible force of a push"),
        (lambda: nima.remove_gravity({"a": 1}, forces_n, world_from_sensor_wxyz=wxyz), "model is not a gravity model"),
    ]:
        with pytest.raises(ValueError, match=words) as caught:
            call()
        assert "\n" not in str(caught.value)
