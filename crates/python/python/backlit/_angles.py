"""The angles that clinicians read, from where joints are.

Flexion of elbow and knee is 180° less the angle between the two limbs at the joint: 0 is straight. That of the shoulder is the
angle between the upper arm and the trunk's direction downwards, that of the hip between the thigh and the trunk's: 0 is an
arm that hangs, and who stands upright.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from backlit import Track

# Where the two lines of an angle begin and end, by joint; a joint is named after the limb that ends there.
_SIDE = {
    "elbow": (("clavicle", "upper arm"), ("upper arm", "forearm")),
    "knee": (("hip", "lower thigh"), ("lower thigh", "lower calf")),
    "shoulder": (None, ("clavicle", "upper arm")),
    "hip": (None, ("hip", "lower thigh")),
}


def of_track(track: "Track") -> dict[str, NDArray[np.float64]]:
    """Degrees by name, an array (T,) each: ``left elbow flexion`` … of the joints that the body has."""
    names, joints = track.joint_names, track.joints

    def line(begin: str, end: str) -> NDArray[np.float64] | None:
        if begin not in names or end not in names:
            return None
        return np.asarray(joints[:, names.index(end)] - joints[:, names.index(begin)])

    angles = {}
    trunk = line("chest", "root")
    for side in ("left", "right"):
        for joint, (first, second) in _SIDE.items():
            above = trunk if first is None else line(f"{side} {first[0]}", f"{side} {first[1]}")
            below = line(f"{side} {second[0]}", f"{side} {second[1]}")
            if above is not None and below is not None:
                angles[f"{side} {joint} flexion"] = _between(above, below)
    return angles


def _between(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Degrees between directions, row by row."""
    across = np.linalg.norm(np.cross(a, b), axis=-1)
    degrees: NDArray[np.float64] = np.degrees(np.arctan2(across, np.sum(a * b, axis=-1)))
    return degrees
