"""A fit, iteration by iteration."""

import json
from pathlib import Path

import numpy as np
import pytest

import backlit as bl

from .conftest import Recording, backlit


def off(recording: Recording, angle: float = 0.08) -> bl.Pose:
    columns = 3 + 3 * len(recording.start.rotations)
    return recording.start.moved(np.r_[0.03, -0.02, 0.02, angle * np.cos(np.arange(columns - 3))])


def test_steps_are_the_command_lines(recording: Recording, tmp_path: Path) -> None:
    start = off(recording)
    fit = bl.iterate(recording.cams, recording.masks[:, 0], start, body=recording.body)
    steps = list(fit)
    assert fit.termination is not None and next(iter(fit), None) is None
    bl.Take.from_arrays(recording.cams, recording.masks[:, :1], body=recording.body).save(tmp_path / "take")
    start.save(tmp_path / "start.json", recording.body)
    done = backlit("fit", "take", "--frame", 0, "--start", "start.json", "--json", "--out", "pose.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert [step.cost for step in steps] == told["costs"]
    assert [step.accepted for step in steps[1:]] == [one["accepted"] for one in told["iterations"]]
    assert [step.damping for step in steps[1:]] == [one["damping"] for one in told["iterations"]]
    assert fit.termination == told["termination"]["reason"]
    assert steps[-1].pose == bl.Pose.load(tmp_path / "pose.json", recording.body)


def test_arrays_of_a_step(recording: Recording) -> None:
    decided = recording.masks[:, 0] == 255
    fit = bl.iterate(recording.cams, decided, off(recording), body=recording.body, preset="report", iterations=3)
    start, *steps = fit
    assert start.number == 0 and start.accepted and len(steps) == 3
    last = steps[-1]
    columns = 3 + 4 * len(last.pose.rotations)
    assert last.gradient.shape == (columns,) and last.normal_matrix.shape == (columns, columns)
    assert last.joints.shape == (len(recording.body.joint_names), 3)
    drawn = bl.render(fit.cameras, fit.body, last.pose, ramp=last.ramp)
    for picture, prediction, size in zip(drawn, last.prediction, fit.cameras.size):
        assert prediction.shape == (size[1], size[0]) and prediction.flags.owndata
        np.testing.assert_array_equal(picture, prediction)
    # JᵀJ of all pixels: this preset has no priors and leaves no pixel out.
    dense = np.concatenate(last.jacobian)
    expected = dense.T @ dense
    np.testing.assert_allclose(last.normal_matrix, expected, atol=2e-3 * np.abs(expected).max())
    np.testing.assert_array_equal(last.normal_matrix, last.normal_matrix.T)


def test_gradient_is_the_difference_of_costs(recording: Recording) -> None:
    start = off(recording)

    def at(pose: bl.Pose) -> bl.Step:
        options = {"body": recording.body, "preset": "report", "parameters": "tangent"}
        return next(bl.iterate(recording.cams, recording.masks[:, 0], pose, **options))  # type: ignore[arg-type]

    gradient, step = at(start).gradient, 1e-4
    rng = np.random.default_rng(3)
    for _ in range(6):
        direction = rng.normal(size=len(gradient))
        difference = (at(start.moved(step * direction)).cost - at(start.moved(-step * direction)).cost) / (2 * step)
        assert difference == pytest.approx(gradient @ direction, rel=0.02, abs=2e-3 * np.linalg.norm(gradient))


def test_three_renderers_go_down(recording: Recording) -> None:
    for renderer in ("capsule", "cylinder", "sphere_tree"):
        fit = bl.iterate(recording.cams, recording.masks[:, 0], off(recording), body=recording.body, renderer=renderer)
        steps = [step for step in fit if step.stage == 0]
        assert steps[-1].cost < 0.8 * steps[0].cost
        for before, after in zip(steps, steps[1:]):
            assert after.accepted or (after.pose == before.pose and after.cost == before.cost)


def test_threads_change_nothing(recording: Recording) -> None:
    costs = [
        [step.cost for step in bl.iterate(recording.cams, recording.masks[:, 0], off(recording), body=recording.body, n_threads=n)]
        for n in (None, 1, 3)
    ]
    assert costs[0] == costs[1] == costs[2]
