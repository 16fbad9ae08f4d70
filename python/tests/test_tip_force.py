"""The network in Python: the same as what the program evaluates."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import nima
from conftest import Program

COLUMNS = ("fx_n fy_n fz_n tx_nm ty_nm tz_nm qw qx qy qz insertion_m insertion_speed_m_s presliding_200um_m "
           "presliding_600um_m slip_m_s").split()
OUTPUTS = ("tip_fx_n", "tip_fy_n", "tip_fz_n")


def data(path: Path, seed: int) -> np.ndarray:
    """A data set in which the tip's force is the wrist's without a friction of the sign of the speed."""
    random = np.random.default_rng(seed)
    rows = random.normal(0.0, 1.0, (600, len(COLUMNS)))
    rows[:, 6:10] = [1.0, 0.0, 0.0, 0.0]
    rows[:, 10] = 0.1 + 0.02 * rows[:, 10]
    rows[:, 11:] *= 0.01
    tip_n = rows[:, :3] - [0.0, 0.0, 0.5] * np.tanh(rows[:, 11:12] / 0.005)
    names = [*COLUMNS, *OUTPUTS, "trajectory"]
    groups = np.arange(600) // 60
    lines = [",".join(names)] + [",".join(map(repr, [*row, *tip, int(group)])) for row, tip, group in
                                 zip(rows.tolist(), tip_n.tolist(), groups)]
    path.write_text("\n".join(lines) + "\n")
    return rows


@pytest.fixture(scope="module")
def model(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("model")
    data(folder / "train.csv", 1)
    path = folder / "model.safetensors"
    program.run("train", "tip-force", folder / "train.csv", "--out", path, "--epochs", 20, "--members", 2, "--hidden", "8,8")
    return path


def test_estimates_agree_with_the_programs(program, model, tmp_path):
    network = nima.TipForceModel(model)
    assert network.inputs == COLUMNS and network.outputs == list(OUTPUTS) and network.origin
    rows = data(tmp_path / "new.csv", 2)
    program.run("evaluate", "tip-force", model, tmp_path / "new.csv", "--out", tmp_path / "out")
    with (tmp_path / "out" / "predictions.csv").open() as file:
        told = list(csv.DictReader(file))
    estimates = nima.TipForceModel(model).estimate(rows)
    predicted = np.array([[float(row[f"{name}_predicted"]) for name in OUTPUTS] for row in told], dtype=np.float32)
    assert np.array_equal(estimates.output.astype(np.float32), predicted)
    assert estimates.in_doubt.tolist() == [row["in_doubt"] == "1" for row in told]
    assert estimates.spread.shape == (600, 3) and np.array_equal(estimates.in_doubt, estimates.doubt > 1.0)


def test_inference_begins_with_the_first_motion(model):
    network = nima.TipForceModel(model)
    times_s = np.arange(2000) * 1e-3
    forces_n = np.tile([0.3, -0.2, 0.6], (2000, 1))
    wxyz = np.tile([1.0, 0.0, 0.0, 0.0], (2000, 1))
    still = network.infer(times_s, forces_n, forces_n * 0.01, wxyz, np.full(2000, 0.1))
    assert np.isinf(still.doubt).all() and not still.network_share.any(), "no motion, no direction of friction"
    moving = network.infer(times_s, forces_n, forces_n * 0.01, wxyz, 0.1 + 0.01 * np.sin(6.0 * times_s))
    assert np.isfinite(moving.doubt[500:]).all() and np.isfinite(moving.forces_n).all()
    faded = network.infer(times_s, forces_n, forces_n * 0.01, wxyz, np.full(2000, 0.1), fallback="hold_and_fade")
    assert not faded.forces_n.any()


def test_what_cannot_be_used_is_one_clear_line(model, tmp_path):
    network = nima.TipForceModel(model)
    with pytest.raises(ValueError, match=r"inputs has the shape \(5, 3\); give the shape \(n, 15\)"):
        network.estimate(np.zeros((5, 3)))
    with pytest.raises(ValueError, match="inputs, row 4: NaN"):
        network.estimate(np.vstack([np.zeros((4, 15)), np.full((1, 15), np.nan)]))
    ones = np.ones((3, 3))
    with pytest.raises(ValueError, match="insertion_m needs 3 finite numbers, it has 2"):
        network.infer(np.arange(3.0), ones, ones, np.tile([1.0, 0, 0, 0], (3, 1)), np.ones(2))
    with pytest.raises(ValueError, match="fallback: unknown variant"):
        network.infer(np.arange(3.0), ones, ones, np.tile([1.0, 0, 0, 0], (3, 1)), np.ones(3), fallback="hope")
    with pytest.raises(OSError, match="none.safetensors"):
        nima.TipForceModel(tmp_path / "none.safetensors")
    (tmp_path / "text.safetensors").write_text("nothing")
    with pytest.raises(ValueError, match="text.safetensors"):
        nima.TipForceModel(tmp_path / "text.safetensors")
