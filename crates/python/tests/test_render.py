"""Predictions and their derivatives, against differences."""

import numpy as np
import pytest

import backlit as bl

from .conftest import Recording, backlit

RENDERERS = ("capsule", "cylinder", "sphere_tree")


@pytest.mark.parametrize("renderer", RENDERERS)
@pytest.mark.parametrize("parameters", ["tangent", "raw"])
def test_jacobian_is_the_difference_of_predictions(recording: Recording, renderer: str, parameters: str) -> None:
    cams, pose = recording.cams.select(recording.cams.names[:2]), recording.start
    options = {"renderer": renderer, "ramp": "half"}
    dense = bl.jacobian(cams, recording.body, pose, parameters=parameters, **options)  # type: ignore[arg-type]
    columns = dense[0].shape[1]
    rotations = len(pose.rotations)
    assert columns == 3 + rotations * (3 if parameters == "tangent" else 4)

    def nudged(column: int, by: float) -> list[np.ndarray]:
        if parameters == "tangent":
            moved = pose.moved(by * np.eye(columns)[column])
        else:
            root, turns = pose.root, pose.rotations
            if column < 3:
                root[column] += by
            else:
                turns.flat[column - 3] += by
            moved = bl.Pose(root, turns)
        return bl.render(cams, recording.body, moved, **options)  # type: ignore[arg-type]

    step, compared = 1e-6, 0
    for column in (0, 1, 2, 3, 5, 8, columns - 2):
        before, after = nudged(column, -step), nudged(column, step)
        for camera, (a, b) in enumerate(zip(before, after)):
            difference = ((b - a) / (2 * step)).ravel()
            exact = dense[camera][:, column]
            # Where another limb wins the pixel, or the ramp is clipped, a difference is of two functions.
            off = np.abs(difference - exact) > 1e-3 * np.maximum(1.0, np.abs(exact))
            assert off.mean() < 2e-4, f"{renderer}, camera {camera}, column {column}: {off.sum()} pixels"
            compared += int((exact != 0).sum())
    assert compared > 5_000


def test_predictions_are_the_command_lines(recording: Recording, tmp_path) -> None:
    recording.cams.save(tmp_path / "cameras.json")
    recording.start.save(tmp_path / "pose.json", recording.body)
    recording.body.save(tmp_path / "body.toml")
    words = ["render", "--model", "body.toml", "--cameras", "cameras.json", "--pose", "pose.json", "--npy", "--jacobian", "raw"]
    done = backlit(*words, "--renderer", "sphere-tree", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    pictures = bl.render(recording.cams, recording.body, recording.start, renderer="sphere_tree")
    dense = bl.jacobian(recording.cams, recording.body, recording.start, renderer="sphere_tree", parameters="raw")
    for name, picture, jacobian in zip(recording.cams.names, pictures, dense):
        assert picture.flags.owndata and picture.flags.c_contiguous
        np.testing.assert_array_equal(picture, np.load(tmp_path / "out" / f"{name}.prediction.npy"))
        np.testing.assert_array_equal(jacobian, np.load(tmp_path / "out" / f"{name}.jacobian.npy"))


def test_joints_and_poses(recording: Recording) -> None:
    body = recording.body
    joints = body.joints(recording.start)
    assert joints.shape == (len(body.joint_names), 3) and body.joint_names[0] == "root"
    np.testing.assert_array_equal(joints[0], recording.start.root)
    # The end of a limb is its length away from where it begins.
    names = body.joint_names
    for limb, parent, length in zip(body.limb_names, body.parents, body.lengths):
        begin = joints[names.index(parent) if parent else 0]
        np.testing.assert_allclose(np.linalg.norm(joints[names.index(limb)] - begin), length, atol=1e-12)
    assert bl.Pose(recording.start.root, recording.start.rotations) == recording.start
    taller = body.with_sizes(1.1 * body.lengths, body.radii)
    np.testing.assert_allclose(taller.lengths, 1.1 * body.lengths)
