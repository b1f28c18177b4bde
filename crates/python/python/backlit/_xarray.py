"""A track as an ``xarray.Dataset``. xarray is imported when it is asked for."""

from typing import TYPE_CHECKING

from backlit._errors import Error

if TYPE_CHECKING:
    import xarray

    from backlit import Track


def of_track(track: "Track") -> "xarray.Dataset":
    """Its arrays with the coordinates frame, joint, camera, axis, rotation and quaternion; metres, degrees and seconds."""
    try:
        import xarray
    except ImportError as error:
        raise Error("to_xarray needs xarray: pip install xarray") from error
    angles = {name: (("frame",), values, {"units": "degrees"}) for name, values in track.angles.items()}
    return xarray.Dataset(
        {
            "joints": (("frame", "joint", "axis"), track.joints, {"units": "m"}),
            "sigma": (("frame", "joint"), track.sigma, {"units": "m"}),
            "error_95": (("frame", "joint"), track.error_95, {"units": "m"}),
            "wrong": (("frame", "joint"), track.wrong),
            "iou": (("frame", "camera"), track.iou),
            "cost": (("frame",), track.cost),
            "verdict": (("frame",), track.verdict),
            "rotations": (("frame", "rotation", "quaternion"), track.rotations),
            **angles,
        },
        coords={
            "frame": track.frames,
            "seconds": (("frame",), track.seconds, {"units": "s"}),
            "joint": track.joint_names,
            "camera": track.camera_names,
            "axis": list("xyz"),
            "rotation": track.rotation_names,
            "quaternion": list("wxyz"),
        },
        attrs={"fps": track.fps, "body": track.body.name},
    )
