"""Tracks: what they hold, the same bits as the command line, threads, borrowed masks."""

import json
from pathlib import Path

import numpy as np
import pytest

import backlit as bl

from .conftest import FRAMES, Recording, backlit


@pytest.fixture(scope="module")
def track(recording: Recording) -> bl.Track:
    return bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, fps=30)


def same(a: bl.Track, b: bl.Track) -> bool:
    pairs = [(a.joints, b.joints), (a.sigma, b.sigma), (a.iou, b.iou), (a.cost, b.cost), (a.rotations, b.rotations)]
    return all(np.array_equal(one, other, equal_nan=True) for one, other in pairs) and a.verdict == b.verdict


def test_a_track_holds(track: bl.Track, recording: Recording) -> None:
    joints, cameras = len(recording.body.joint_names), len(recording.cams)
    assert track.joints.shape == (FRAMES, joints, 3) and track.joints.flags.owndata
    assert track.sigma.shape == track.error_95.shape == track.wrong.shape == (FRAMES, joints)
    assert track.iou.shape == (FRAMES, cameras) and (track.iou > 0.7).all()
    assert track.rotations.shape == (FRAMES, len(track.rotation_names), 4)
    np.testing.assert_allclose(np.linalg.norm(track.rotations, axis=-1), 1.0, atol=1e-12)
    assert (track.sigma > 0).all() and (track.sigma < track.error_95).all()
    assert set(track.verdict) <= {"good", "doubtful", "wrong", "lost"} and len(track.verdict) == FRAMES
    assert track.frames.tolist() == list(range(FRAMES)) and track.seconds[-1] == pytest.approx((FRAMES - 1) / 30)
    for pose, place in zip(track.poses, track.joints):
        np.testing.assert_array_equal(track.body.joints(pose), place)


def test_the_truth_is_found(track: bl.Track) -> None:
    errors = bl.fit(bl.Take.load(), frames=range(FRAMES))
    # The built-in take's silhouettes are segmented, those given are the same masks.
    assert np.linalg.norm(track.joints - errors.joints, axis=-1).mean() < 0.03


def test_the_same_bits_as_the_command_line(track: bl.Track, recording: Recording, tmp_path: Path) -> None:
    take = bl.Take.from_arrays(recording.cams, recording.masks, body=recording.body, start=recording.start, fps=30)
    take.save(tmp_path / "take")
    done = backlit("track", "take", "--out", "results", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "results" / "track.json").read_text())["frames"]
    joints = np.array([[frame["joints"][name] for name in track.joint_names] for frame in told])
    np.testing.assert_array_equal(joints, track.joints)
    iou = np.array([[frame["iou"][name] for name in track.camera_names] for frame in told], dtype=float)
    np.testing.assert_array_equal(iou, track.iou)
    # Also by the take that was written, and by the whole search for a start.
    assert same(bl.fit(bl.Take.load(tmp_path / "take")), track)


@pytest.mark.parametrize("motion", ["still", "kalman", "smoothed"])
def test_motion_is_carried_as_the_command_line_does(motion: str, recording: Recording, tmp_path: Path) -> None:
    take = bl.Take.from_arrays(recording.cams, recording.masks, body=recording.body, start=recording.start, fps=30)
    take.save(tmp_path / "take")
    done = backlit("track", "take", "--motion", motion, "--out", "results", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "results" / "track.json").read_text())["frames"]
    track = bl.fit(take, motion=motion)
    joints = np.array([[frame["joints"][name] for name in track.joint_names] for frame in told])
    np.testing.assert_array_equal(joints, track.joints)
    iou = np.array([[frame["iou"][name] for name in track.camera_names] for frame in told], dtype=float)
    np.testing.assert_array_equal(iou, track.iou)


def test_one_of_several_people_is_followed(recording: Recording) -> None:
    one = bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, fps=30, person=1)
    assert np.linalg.norm(one.joints[-1] - one.joints[0], axis=-1).mean() < 1.0
    with pytest.raises(bl.Error, match="person 2"):
        bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, person=2)
    with pytest.raises(bl.InputError, match="cameras"):
        bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, person=1, cameras=recording.cams.names[:1])
    with pytest.raises(bl.InputError, match="motion"):
        bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, motion="fast")  # type: ignore[arg-type]


def test_a_start_is_searched_for_as_the_command_line_does(recording: Recording, tmp_path: Path) -> None:
    masks = recording.masks[:, :2]
    bl.Take.from_arrays(recording.cams, masks, body=recording.body).save(tmp_path / "take")
    done = backlit("track", "take", "--out", "results", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "results" / "track.json").read_text())["frames"]
    track = bl.fit(recording.cams, masks, body=recording.body, n_threads=2)
    assert "a start was found" in " ".join(track.notes)
    joints = np.array([[frame["joints"][name] for name in track.joint_names] for frame in told])
    np.testing.assert_array_equal(joints, track.joints)


def test_pictures_are_tracked_as_the_command_line_does(tmp_path: Path) -> None:
    folder = Path(__file__).parents[3] / "assets" / "take"
    done = backlit("track", folder, "--frames", "20..28", "--out", "results", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "results" / "track.json").read_text())["frames"]
    track = bl.fit(bl.Take.load(folder), frames=range(20, 28), n_threads=2)
    joints = np.array([[frame["joints"][name] for name in track.joint_names] for frame in told])
    np.testing.assert_array_equal(joints, track.joints)
    trust = np.array([[frame["trust"][name]["error_95"] for name in track.joint_names[1:]] for frame in told])
    np.testing.assert_array_equal(trust, track.error_95[:, 1:])


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_change_no_bit(track: bl.Track, recording: Recording, threads: int) -> None:
    other = bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, fps=30, n_threads=threads)
    assert same(other, track)


def test_masks_of_any_kind(track: bl.Track, recording: Recording) -> None:
    cams, masks, told = recording.cams, recording.masks, {"body": recording.body, "start": recording.start, "fps": 30.0}
    assert set(np.unique(masks)) == {0, 128, 255}, "some of it is unknown"
    assert same(bl.fit(cams, np.asfortranarray(masks), **told), track)  # type: ignore[arg-type]
    assert same(bl.fit(cams, masks[..., ::-1][..., ::-1], mask_values="classes", **told), track)  # type: ignore[arg-type]
    subject = masks == 255
    decided = bl.fit(cams, subject, **told)  # type: ignore[arg-type]
    assert not same(decided, track)
    assert same(bl.fit(cams, list(subject), **told), decided)  # type: ignore[arg-type]
    assert same(bl.fit(cams, subject.astype(np.uint8), **told), decided)  # type: ignore[arg-type]
    assert same(bl.fit(cams, 255 * subject.astype(np.uint8), **told), decided)  # type: ignore[arg-type]
    ids = np.where(subject, 7, 3).astype(np.uint8)
    assert same(bl.fit(cams, ids, mask_values=[7], **told), decided)  # type: ignore[arg-type]


def test_cameras_of_different_sizes(track: bl.Track, recording: Recording) -> None:
    """A camera whose pictures are cut off at the bottom, where nobody is seen."""
    cams, masks = recording.cams, list(recording.masks)
    rows = 4
    assert not masks[1][:, -rows:].any()
    size = cams.size
    size[1, 1] -= rows
    other = bl.CameraGroup.from_arrays(cams.matrix, cams.rotation, cams.translation, size, names=cams.names)
    masks[1] = masks[1][:, :-rows]
    found = bl.fit(other, masks, body=recording.body, start=recording.start, fps=30)
    assert np.linalg.norm(found.joints - track.joints, axis=-1).max() < 0.03


def test_masks_are_borrowed(recording: Recording) -> None:
    """Twenty gigabytes, if they were copied: a view that repeats a frame without end."""
    masks = np.broadcast_to(recording.masks[:, :1], (4, 100_000, *recording.masks.shape[2:]))
    take = bl.Take.from_arrays(recording.cams, masks, body=recording.body, start=recording.start)
    assert take.frame_count == 100_000
    np.testing.assert_array_equal(take.masks(99_999)[2], masks[2, 99_999])
    found = bl.fit(take, frames=[70_000, 70_001])
    assert found.frames.tolist() == [70_000, 70_001] and (found.iou > 0.7).all()


def test_keypoints_are_cues(recording: Recording, track: bl.Track) -> None:
    order = ["left clavicle", "right clavicle", "left upper arm", "right upper arm", "left forearm", "right forearm", "left hip",
             "right hip", "left lower thigh", "right lower thigh", "left lower calf", "right lower calf"]  # fmt: skip
    pixels = recording.cams.project(track.joints)
    keypoints = np.full((*pixels.shape[:2], 17, 3), np.nan)
    keypoints[:, :, 5:, :2] = pixels[:, :, [track.joint_names.index(name) for name in order]]
    keypoints[:, :, 5:, 2] = 0.9
    told = {"body": recording.body, "start": recording.start, "fps": 30.0}
    found = bl.fit(recording.cams, recording.masks, keypoints=keypoints, **told)  # type: ignore[arg-type]
    assert np.linalg.norm(found.joints - track.joints, axis=-1).max() < 0.1
    with pytest.raises(bl.Error, match="keypoints: they make no body"):
        bl.fit(recording.cams, recording.masks, keypoints=0 * keypoints, **told)  # type: ignore[arg-type]


def test_angles(track: bl.Track) -> None:
    angles = track.angles
    assert {f"{side} {joint} flexion" for side in ("left", "right") for joint in ("elbow", "knee", "hip", "shoulder")} == set(angles)
    at = {name: track.joints[:, index] for index, name in enumerate(track.joint_names)}
    upper, fore = at["left clavicle"] - at["left upper arm"], at["left forearm"] - at["left upper arm"]
    cosine = (upper * fore).sum(-1) / np.linalg.norm(upper, axis=-1) / np.linalg.norm(fore, axis=-1)
    np.testing.assert_allclose(angles["left elbow flexion"], 180 - np.degrees(np.arccos(cosine)), atol=1e-6)
    # The right thigh in the trunk's sagittal plane, by NumPy alone.
    across = at["right hip"] - at["left hip"]
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    up = at["left clavicle"] + at["right clavicle"] - at["left hip"] - at["right hip"]
    up -= (up * across).sum(-1, keepdims=True) * across
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    thigh = at["right lower thigh"] - at["right hip"]
    expected = np.degrees(np.arctan2((thigh * np.cross(up, across)).sum(-1), -(thigh * up).sum(-1)))
    np.testing.assert_allclose(angles["right hip flexion"], expected, atol=1e-6)


def test_files_of_motion(track: bl.Track, tmp_path: Path) -> None:
    track.to_trc(tmp_path / "a.trc")
    track.to_bvh(tmp_path / "a.bvh")
    assert (tmp_path / "a.trc").read_text().startswith("PathFileType\t4\t(X/Y/Z)")
    assert "HIERARCHY" in (tmp_path / "a.bvh").read_text()
    for ending in ("c3d", "glb", "mot", "csv", "npz"):
        track.save(tmp_path / f"a.{ending}")
    with np.load(tmp_path / "a.npz") as arrays:
        assert arrays["joints"].shape == track.joints.shape
    with pytest.raises(bl.InputError, match='path: expected a name that ends in bvh.*got "doc"'):
        track.save(tmp_path / "a.doc")


def test_xarray(track: bl.Track) -> None:
    pytest.importorskip("xarray")
    data = track.to_xarray()
    assert data.joints.dims == ("frame", "joint", "axis") and data.attrs["fps"] == 30
    wrist = data.joints.sel(joint="left forearm", axis="z").values
    np.testing.assert_array_equal(wrist, track.joints[:, track.joint_names.index("left forearm"), 2])
