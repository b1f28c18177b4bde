"""Cameras checked against one another, and refined."""

import numpy as np
import pytest

import backlit as bl

from .conftest import Recording

EVERY = 2


@pytest.fixture(scope="module")
def moving() -> tuple[bl.Take, bl.CameraGroup, np.ndarray]:
    take = bl.Take.load()
    frames = range(0, take.frame_count, EVERY)
    return take, take.ideal_cameras, np.stack([np.stack(take.masks(frame)) for frame in frames], axis=1)


def test_a_wrong_focal_length_is_told_and_repaired(moving: tuple[bl.Take, bl.CameraGroup, np.ndarray]) -> None:
    take, cams, masks = moving
    matrix = cams.matrix
    matrix[2, :2, :2] *= 1.15
    bad = bl.CameraGroup.from_arrays(matrix, cams.rotation, cams.translation, cams.size, names=cams.names)
    found = bl.check(bad, masks, fps=take.fps / EVERY)
    assert found, "nothing was found"
    assert found[0].camera == cams.names[2] and "focal" in found[0].kind, found
    assert found[0].text.startswith(f"{cams.names[2]} ") and found[0].apart_px is not None
    before, after = found[0].apart_px
    assert after < before
    repaired = found[0].cameras
    assert repaired is not None
    off = [abs(group.matrix[2, 0, 0] - cams.matrix[2, 0, 0]) for group in (bad, repaired)]
    assert off[1] < 0.5 * off[0]


def test_good_cameras_are_good(moving: tuple[bl.Take, bl.CameraGroup, np.ndarray]) -> None:
    assert bl.check(moving[0]) == []


def test_a_turned_camera_is_refined(moving: tuple[bl.Take, bl.CameraGroup, np.ndarray]) -> None:
    take, cams, masks = moving
    turn = np.radians(1.5)
    about_y = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    rotation, translation = cams.rotation, cams.translation
    rotation[1], translation[1] = about_y @ rotation[1], about_y @ translation[1]
    bad = bl.CameraGroup.from_arrays(cams.matrix, rotation, translation, cams.size, names=cams.names)
    told: list[str] = []
    found = bl.refine(
        bad, masks, body=take.body, start=take.start, fps=take.fps / EVERY, count=6, progress=lambda _done, _all, text: told.append(text)
    )
    before, after = found.report["iou"]
    assert after > before and "cameras" in told

    def off(group: bl.CameraGroup) -> float:
        """Pixels by which the camera and the others disagree on the body's joints, whatever the rig as a whole does."""
        joints = take.body.joints(take.start) if take.start else np.zeros((1, 3))
        centred = group.project(joints)[1] - cams.project(joints)[1]
        others = group.project(joints)[[0, 2, 3]] - cams.project(joints)[[0, 2, 3]]
        return float(np.linalg.norm(centred.mean(axis=0)) + np.linalg.norm(others.mean(axis=1), axis=-1).mean())

    assert off(found.cameras) < 0.6 * off(bad)
    assert found.body.lengths.shape == take.body.lengths.shape


def test_arguments_are_checked(recording: Recording) -> None:
    with pytest.raises(bl.InputError, match="count: expected 3 to 64; got 2"):
        bl.refine(recording.cams, recording.masks, count=2)
    with pytest.raises(bl.InputError, match="free: expected focal_length.*got \"lens\""):
        bl.refine(recording.cams, recording.masks, free=["lens"])  # type: ignore[list-item]
