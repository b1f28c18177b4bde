"""Errors name the argument, what was expected and what came, and have their causes."""

from pathlib import Path

import numpy as np
import pytest

import backlit as bl

from .conftest import Recording


def test_masks_that_do_not_fit(recording: Recording) -> None:
    cams, masks = recording.cams, recording.masks
    height, width = masks.shape[2:]
    with pytest.raises(bl.InputError, match=r"masks: expected an array \(cameras, frames, height, width\) of bool or uint8.*; got float64 of the shape"):
        bl.fit(cams, masks.astype(float))  # type: ignore[arg-type]
    with pytest.raises(bl.InputError, match=rf"masks: .*; got uint8 of the shape \(4, {height}, {width}\)"):
        bl.fit(cams, masks[:, 0])
    with pytest.raises(bl.InputError, match="masks: expected masks of 4 cameras, as there are in cams; got 3"):
        bl.fit(cams, masks[:3])
    with pytest.raises(bl.InputError, match=rf"masks\[0\]: expected height and width {height} × {width}, the size of camera .*; got {width} × {height}"):
        bl.fit(cams, masks.swapaxes(2, 3))
    with pytest.raises(bl.InputError, match=r"masks\[2\]: expected 6 frames, as masks\[0\] has; got 5"):
        bl.fit(cams, [masks[0], masks[1], masks[2][:5], masks[3]])
    with pytest.raises(bl.InputError, match="masks: .*; got str"):
        bl.fit(cams, "masks")  # type: ignore[arg-type]
    with pytest.raises(bl.InputError, match="masks: expected arrays beside a CameraGroup; got None"):
        bl.fit(cams)
    with pytest.raises(bl.InputError, match=r"masks: expected an array \(cameras, height, width\)"):
        bl.iterate(cams, masks)


def test_other_arguments(recording: Recording) -> None:
    cams, masks = recording.cams, recording.masks
    told = {"body": recording.body, "start": recording.start}
    for options, expected in [
        ({"renderer": "cone"}, 'renderer: "cone" is not a renderer; expected capsule, cylinder or sphere-tree'),
        ({"preset": "best"}, 'preset: "best" is not a preset; expected report or robust'),
        ({"n_threads": 0}, "n_threads: expected 1 to 1024; got 0"),
        ({"frames": [9]}, "frames: expected numbers below 6; got 9"),
        ({"cameras": ["x"]}, 'cameras: there is no camera "x"'),
        ({"cues": ["smell"]}, 'cues: expected keypoints, flow or stereo; got "smell"'),
        ({"sizes": "large"}, 'sizes: expected "known" or "fit"; got "large"'),
        ({"fps": -1.0}, "fps: expected frames a second, above 0; got -1"),
        ({"mask_values": "odd"}, 'mask_values: expected .*; got "odd"'),
        ({"keypoints": np.zeros((4, 6, 17, 2))}, r"keypoints: expected an array \(4, 6, keypoints, 3\)"),
    ]:
        with pytest.raises(bl.InputError, match=expected):
            bl.fit(cams, masks, **{**told, **options})  # type: ignore[arg-type]
    with pytest.raises(bl.InputError, match="rotations"):
        bl.fit(cams, masks, body=recording.body, start=bl.Body("upper_body").rest())
    with pytest.raises(bl.InputError, match="fps: expected none beside a Take"):
        bl.fit(bl.Take.load(), fps=25)
    with pytest.raises(bl.InputError, match="frame: expected a number below 60; got 60"):
        bl.Take.load().masks(60)
    with pytest.raises(bl.InputError, match="frame: expected a number below 1; got 3"):
        bl.iterate(cams, masks[:, 0], frame=3)
    with pytest.raises(bl.InputError, match="root: expected three numbers, metres; got the shape"):
        bl.Pose([1, 2], np.zeros((3, 4)))


def test_types_that_do_not_fit(recording: Recording) -> None:
    with pytest.raises(TypeError, match="cams: expected a CameraGroup or a Take; got str"):
        bl.fit("cameras.json", recording.masks)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="body: expected a Body, a name or a path; got float"):
        bl.fit(recording.cams, recording.masks, body=1.8)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="not an instance of 'Pose'"):
        bl.fit(recording.cams, recording.masks, start=recording.body)  # type: ignore[arg-type]


def test_errors_are_pythons_kinds(recording: Recording, tmp_path: Path) -> None:
    assert issubclass(bl.InputError, ValueError) and issubclass(bl.FileError, OSError)
    assert issubclass(bl.InputError, bl.Error) and issubclass(bl.FileError, bl.Error)
    (tmp_path / "take.toml").write_text('format = "backlit-take 1"\nname = 3\n')
    with pytest.raises(bl.FileError, match=r"take\.toml, line 2: .*name"):
        bl.Take.load(tmp_path)


def test_causes_are_chained(recording: Recording) -> None:
    nobody = np.zeros_like(recording.masks)
    with pytest.raises(bl.Error) as caught:
        bl.fit(recording.cams, nobody, body=recording.body)
    error: BaseException | None = caught.value
    messages = []
    while error is not None:
        messages.append(str(error))
        error = error.__cause__
    assert "cam" in messages[0]
    for outer, inner in zip(messages, messages[1:]):
        assert outer.endswith(inner)
    with pytest.raises(bl.Error) as caught:
        bl.CameraGroup.from_arrays([np.eye(3)], [2 * np.eye(3)], np.zeros((1, 3)), (100, 100))
    assert str(caught.value).startswith('camera "cam1": ') and "not a rotation" in str(caught.value.__cause__)
