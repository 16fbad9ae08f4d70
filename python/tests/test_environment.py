"""The simulated loop, step by step."""

from __future__ import annotations

import re
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import nima
from conftest import ROOT


def episode(environment: nima.Environment, actions: list, seed: int = 3) -> list:
    """Observation and info after each step."""
    environment.reset(seed=seed)
    steps = []
    for action in actions:
        observation, reward, terminated, truncated, info = environment.step(action)
        steps.append((observation, info))
        assert reward == 0.0 and not terminated and not truncated, info
    return steps


@pytest.mark.parametrize("control", ["handle_position", "handle_force", "rendered_force"])
def test_the_checker_of_gymnasium_passes(control):
    environment = nima.Environment("peg_transfer", control=control, substeps=10)
    assert isinstance(environment, gymnasium.Env)
    with warnings.catch_warnings():
        # Ignore its warnings, which are recommendations for other tasks: spaces without bounds, and none that is normalised.
        warnings.simplefilter("ignore", UserWarning)
        check_env(environment, skip_render_check=True)


def test_the_loop_is_that_of_the_program_tick_by_tick(program, tmp_path):
    session = tmp_path / "run.mcap"
    program.run("run", "--virtual", "--seconds", "4", "--scene", "peg_transfer", "--delay-ms", "40", "--record", session)
    ticks = nima.Session(session).ticks("right")
    environment = nima.Environment("peg_transfer", delay_s=0.04, control="nothing")
    # The seed of the scene's file.
    observation, info = environment.reset(seed=7)
    compared, largest_n = 0, 0.0
    index = int(round(info["t_s"] * 1000.0))
    while index < len(ticks.t_s):
        assert np.array_equal(observation["rendered_n"], ticks.rendered_n[index]), info
        assert np.array_equal(observation["command_m"], ticks.leader_m[index])
        # Before the first force has come a session has no number, and an observation zero.
        assert info["has_force"] == np.isfinite(ticks.delayed_n[index]).all()
        assert np.array_equal(observation["delayed_n"], np.nan_to_num(ticks.delayed_n[index]))
        assert np.array_equal(info["tip_m"], ticks.tip_m[index]) and np.array_equal(info["measured_n"], ticks.measured_n[index])
        assert (info["state"], info["mode"]) == (ticks.state[index], "best")
        largest_n = max(largest_n, float(np.linalg.norm(observation["rendered_n"])))
        observation, *_, info = environment.step()
        compared, index = compared + 1, index + 1
    assert compared > 3500 and largest_n > 0.5


def test_steps_of_many_ticks_are_many_steps_of_one():
    one = episode(nima.Environment(control="nothing", substeps=1), [None] * 600)
    ten = episode(nima.Environment(control="nothing", substeps=10), [None] * 60)
    for (left, _), (right, _) in zip(one[9::10], ten):
        assert all(np.array_equal(left[name], right[name]) for name in left)


def test_the_same_seed_is_the_same_to_the_last_bit_and_another_is_not():
    down = [np.array([0.0, 0.0, -1e-4 * step]) for step in range(200)]
    steps = [episode(nima.Environment(substeps=5), down, seed)[-1][0] for seed in (1, 1, 2)]
    assert all(np.array_equal(steps[0][name], steps[1][name]) for name in steps[0])
    assert not np.array_equal(steps[0]["delayed_n"], steps[2]["delayed_n"])


def pressing(environment: nima.Environment, depth_m: float, steps: int) -> list:
    """Leads the handle so that the tip goes down into the tissue, and stays there."""
    observation, info = environment.reset(seed=5)
    start_m, tip_m = observation["handle_m"], info["tip_m"]
    reached = []
    for step in range(steps):
        share = min(1.0, 2.0 * step / steps)
        target_m = start_m + [0.0, 0.0, (-depth_m - tip_m[2]) * share]
        observation, _, terminated, _, info = environment.step(target_m)
        assert not terminated, info
        reached.append((observation, info))
    return reached


def test_a_handle_that_is_placed_presses_the_tissue_and_feels_it_one_delay_late():
    environment = nima.Environment("peg_transfer", "dfr", 0.05, substeps=10)
    reached = pressing(environment, 0.006, 150)
    observation, info = reached[-1]
    assert info["measured_n"][2] > 0.5 and abs(info["tip_m"][2] + 0.006) < 5e-4, info
    for (before, past), (now, _) in zip(reached, reached[5:]):
        assert np.array_equal(now["delayed_n"], past["measured_n"]), "five steps of 10 ms are the delay"
        assert np.array_equal(now["delayed_tip_m"], past["tip_m"])
        assert before.keys() == now.keys()
    felt_n = [float(step["rendered_n"][2]) for step, _ in reached]
    assert max(felt_n) > 0.3


def test_a_handle_that_is_pushed_comes_to_rest_where_forces_are_equal():
    environment = nima.Environment("free_motion", control="handle_force", substeps=10)
    observation, _ = environment.reset(seed=1)
    start_m = observation["handle_m"]
    velocity = np.zeros(3)
    for _ in range(200):
        # A damped spring of 100 N/m towards a point 1 cm aside.
        force_n = 100.0 * (start_m + [0.01, 0.0, 0.0] - observation["handle_m"]) - 10.0 * velocity
        observation, _, terminated, _, info = environment.step(force_n)
        velocity = observation["handle_m_s"]
        assert not terminated, info
    assert np.allclose(observation["handle_m"], start_m + [0.01, 0.0, 0.0], atol=2e-3)


def test_own_rendering_goes_through_the_same_gates():
    environment = nima.Environment("peg_transfer", control="rendered_force", substeps=1)
    assert environment.mode == "dfr"
    environment.reset(seed=1)
    largest_n, acted = 0.0, set()
    for step in range(3000):
        wanted_n = [0.0, 0.0, 50.0] if 600 < step % 1000 < 700 else [0.0, 0.0, 1.0]
        observation, _, terminated, _, info = environment.step(wanted_n)
        assert not terminated, info
        largest_n = max(largest_n, float(np.linalg.norm(observation["rendered_n"])))
        acted.add(info["gate"])
        assert abs(info["asked_n"][2] - wanted_n[2]) < 1e-9
    assert 0.9 < largest_n <= environment.ceiling_n + 1e-9, "50 N were commanded"
    assert acted >= {"slew", "dead_band", "open"}, acted
    environment.step([0.0, 0.0, 1e5])
    *_, info = environment.step([0.0, 0.0, 1e5])
    assert info["gate"] == "validity", "no contact is as hard"


def test_own_reflection_of_the_delayed_force_is_nearly_the_mode_dfr():
    own = nima.Environment("peg_transfer", delay_s=0.03, control="rendered_force")
    ours = nima.Environment("peg_transfer", "dfr", 0.03, control="nothing")
    (observation, _), (reference, _) = own.reset(seed=7), ours.reset(seed=7)
    errors = []
    for _ in range(4000):
        observation, _, terminated, _, info = own.step(observation["delayed_n"])
        reference, *_ = ours.step()
        assert not terminated, info
        errors.append(np.linalg.norm(observation["rendered_n"] - reference["rendered_n"]))
    # One tick late, so the hand is elsewhere by a little, and its tremor continues.
    assert np.mean(errors) < 0.1 and np.max(np.abs(reference["rendered_n"])) >= 0.0


def test_an_episode_ends_by_its_time_and_says_what_is_wrong_afterwards():
    environment = nima.Environment("free_motion", control="nothing", substeps=100, max_seconds=0.5)
    with pytest.raises(ValueError, match="call reset"):
        environment.step()
    environment.reset(seed=1)
    ends = [environment.step()[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]
    with pytest.raises(ValueError, match="the episode is over"):
        environment.step()
    assert environment.score() is None, "no task"


def test_a_fault_of_the_loop_ends_the_episode_with_its_name(tmp_path):
    scene = tmp_path / "slow_arm.toml"
    text = (ROOT / "config" / "scenes" / "free_motion.toml").read_text()
    slow = re.sub(r"bandwidth_hz = [0-9.]+", "bandwidth_hz = 1.0", text)
    assert slow != text
    scene.write_text(slow)
    environment = nima.Environment(str(scene), substeps=10)
    observation, _ = environment.reset(seed=1)
    target_m, terminated = observation["handle_m"] + [0.08, 0.0, 0.0], False
    for _ in range(100):
        _, _, terminated, _, info = environment.step(target_m)
        if terminated:
            break
    assert terminated and info["state"] == "Fault" and "ArmAstray" in info["fault"], info
    with pytest.raises(ValueError, match="the episode is over"):
        environment.step(target_m)


def test_a_task_is_scored():
    environment = nima.Environment("wire", control="nothing", substeps=50, max_seconds=20.0)
    environment.reset(seed=1)
    done, total, steps = False, 0.0, 0
    while not done:
        _, reward, terminated, truncated, info = environment.step()
        total, steps, done = total + reward, steps + 1, terminated or truncated
    assert info["task"]["share"] > 0.3 and abs(total - info["task"]["share"]) < 0.1 and steps > 20, info
    score = environment.score()
    assert score and environment.score() is None


def test_jaws_take_a_fourth_number():
    environment = nima.Environment("rings", substeps=10)
    assert environment.action_space.shape == (4,)
    observation, _ = environment.reset(seed=1)
    _, _, terminated, _, info = environment.step([*observation["handle_m"], 0.5])
    assert not terminated and info["task"] is not None
    with pytest.raises(ValueError, match="the action has 3 numbers, 4 are needed"):
        environment.step(observation["handle_m"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"scene": "no_such"}, "peg_transfer"),
        ({"rig": "no_such"}, "simulated"),
        ({"rig": "emulated"}, "has devices; give a simulated one"),
        ({"scene": "gravity"}, "cannot be engaged"),
        ({"mode": "smith"}, 'unknown mode "smith"'),
        ({"mode": "best", "control": "rendered_force"}, "omit mode"),
        ({"control": "thought"}, "handle_position"),
        ({"delay_s": 3.0}, "delay_s is 3"),
        ({"substeps": 0}, "substeps is 0"),
        ({"max_seconds": 0.0}, "max_seconds is 0"),
    ],
)
def test_what_cannot_be_simulated_is_one_clear_line(arguments, words):
    with pytest.raises(ValueError) as caught:
        nima.Environment(**arguments)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_bad_actions_are_refused_and_change_nothing():
    environment = nima.Environment("free_motion", substeps=5)
    observation, _ = environment.reset(seed=1)
    for action, words in [([0.0], "1 numbers, 3 are needed"), (None, "0 numbers"), ([0.0, np.nan, 0.0], "NaN"), ("ab", "not numbers")]:
        with pytest.raises(ValueError, match=words):
            environment.step(action)
    again, *_ = environment.step(observation["handle_m"])
    assert np.allclose(again["handle_m"], observation["handle_m"], atol=1e-4)
