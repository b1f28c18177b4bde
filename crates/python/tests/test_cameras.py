"""Cameras: numbers in and out, projection against NumPy, files of other tools."""

from pathlib import Path

import numpy as np
import pytest

import backlit as bl

SIZE = (272, 480)


def looking_at(centre: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    z = (target - centre) / np.linalg.norm(target - centre)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    rotation = np.stack([x, np.cross(z, x), z])
    return rotation, -rotation @ centre


def group(distortion: np.ndarray | None = None, fisheye: bool = False) -> bl.CameraGroup:
    places = [looking_at(np.array(at), np.array([0.0, 0.0, 0.9])) for at in ([3.0, 0.2, 1.4], [0.5, -2.8, 1.1], [-2.0, 2.0, 2.0])]
    matrix = np.array([[[420.5, 0, 134.0 + i], [0, 421.0, 240.0 - i], [0, 0, 1]] for i in range(3)])
    return bl.CameraGroup.from_arrays(
        matrix,
        [rotation for rotation, _ in places],
        [translation for _, translation in places],
        SIZE,
        names=["a", "b", "c"],
        distortion=distortion,
        fisheye=fisheye,
    )


def numpy_pixels(cams: bl.CameraGroup, points: np.ndarray, fisheye: bool) -> np.ndarray:
    """OpenCV's formulas, by NumPy alone."""
    pixels = []
    for matrix, rotation, translation, lens in zip(cams.matrix, cams.rotation, cams.translation, cams.distortion):
        p = points @ rotation.T + translation
        x, y = p[..., 0] / p[..., 2], p[..., 1] / p[..., 2]
        k = np.concatenate([lens, np.zeros(8 - len(lens))])
        r2 = x**2 + y**2
        if fisheye:
            r, t = np.sqrt(r2), np.arctan(np.sqrt(r2))
            s = t * (1 + k[0] * t**2 + k[1] * t**4 + k[2] * t**6 + k[3] * t**8) / r
            u, v = x * s, y * s
        else:
            k1, k2, p1, p2, k3, k4, k5, k6 = k
            s = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
            u = x * s + 2 * p1 * x * y + p2 * (r2 + 2 * x**2)
            v = y * s + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y
        pixels.append(np.stack([matrix[0, 0] * u + matrix[0, 2], matrix[1, 1] * v + matrix[1, 2]], axis=-1))
    return np.stack(pixels)


@pytest.mark.parametrize(
    ("lens", "fisheye"),
    [
        ([], False),
        ([-0.05, 0.14, 6e-4, 7e-4, 0.01], False),
        ([0.2, 0.1, 6e-4, 7e-4, 0.01, 0.25, 0.02, 0.001], False),
        ([-0.06, 0.01, -0.004, 3e-4], True),
    ],
)
def test_projection_is_numpys(lens: list[float], fisheye: bool) -> None:
    cams = group(np.tile(lens, (3, 1)), fisheye)
    points = np.random.default_rng(1).normal([0, 0, 0.9], 0.4, (5, 7, 3))
    found = cams.project(points)
    assert found.shape == (3, 5, 7, 2) and found.flags.owndata
    np.testing.assert_allclose(found, numpy_pixels(cams, points, fisheye), atol=1e-9)
    behind = cams.project(cams.centre[0] - 2.0 * (np.array([0, 0, 0.9]) - cams.centre[0]))
    assert np.isnan(behind[0]).all() and behind.shape == (3, 2)


def test_arrays_come_out_as_they_went_in() -> None:
    cams = group()
    assert cams.names == ["a", "b", "c"] and len(cams) == 3
    assert cams.size.tolist() == [list(SIZE)] * 3
    again = bl.CameraGroup.from_arrays(cams.matrix, cams.rotation, cams.translation, cams.size, names=cams.names)
    assert again == cams
    np.testing.assert_allclose(cams.centre[0], [3.0, 0.2, 1.4], atol=1e-12)
    assert cams.select(["c", "a"]).names == ["c", "a"]


def test_pictures_of_half_the_size() -> None:
    cams, points = group(), np.random.default_rng(4).normal([0, 0, 0.9], 0.3, (9, 3))
    half = cams.resized((SIZE[0] // 2, SIZE[1] // 2))
    # A pixel centre at c covers c - 1/2 to c + 1/2.
    np.testing.assert_allclose(half.project(points), (cams.project(points) + 0.5) / 2 - 0.5, atol=1e-9)
    with pytest.raises(bl.InputError, match="size: expected the proportions of 272 × 480; got 480 × 272"):
        cams.resized(SIZE[::-1])


@pytest.mark.parametrize("format", ["backlit", "opencv-yaml", "opencv-xml", "opencv-json", "pose2sim", "anipose", "easymocap", "matrices"])
def test_files_are_read_again(tmp_path: Path, format: str) -> None:
    cams = group()
    path = tmp_path / ("folder" if format == "easymocap" else "cameras.toml")
    cams.save(path, format)  # type: ignore[arg-type]
    found = bl.CameraGroup.load(path, size=SIZE)
    points = np.random.default_rng(2).normal([0, 0, 0.9], 0.3, (9, 3))
    np.testing.assert_allclose(found.project(points), cams.project(points), atol=1e-5)


def test_what_is_no_camera_is_refused() -> None:
    cams = group()
    with pytest.raises(bl.InputError, match=r"rotation: expected an array \(3, 3, 3\); got the shape \(2, 3, 3\)"):
        bl.CameraGroup.from_arrays(cams.matrix, cams.rotation[:2], cams.translation, SIZE)
    with pytest.raises(bl.InputError, match='camera "cam1".*not a rotation'):
        bl.CameraGroup.from_arrays(cams.matrix, 2 * cams.rotation, cams.translation, SIZE)
    with pytest.raises(bl.InputError, match='no camera "d"; there are a, b, c'):
        cams.select(["d"])
    with pytest.raises(bl.FileError, match="nowhere.toml: there is no such file"):
        bl.CameraGroup.load("nowhere.toml")
