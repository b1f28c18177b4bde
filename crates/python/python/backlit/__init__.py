"""Backlit: silhouette-based markerless motion capture.

An articulated body is fitted to the silhouettes that calibrated cameras see of a person::

    import backlit as bl

    cams = bl.CameraGroup.load("cameras.toml")
    track = bl.fit(cams, masks)  # bool or uint8, (cameras, frames, height, width)
    track.joints, track.sigma, track.verdict

Metres, radians unless a name says otherwise, seconds; quaternions w x y z; frames count from 0. Everything computes the same
bits as the command line ``backlit``, which comes with the package, whatever ``n_threads`` is. Work lets other Python threads
run, and Ctrl+C stops it. When the package is imported, the environment variable ``BACKLIT_MEMORY`` says how many gigabytes
pictures may need (4), and ``BACKLIT_VECTORS=256`` makes bits the same on all x86 processors.
"""

from importlib.metadata import PackageNotFoundError, version

from backlit._backlit import (
    Body,
    CameraGroup,
    Finding,
    Iterations,
    Pose,
    Refinement,
    Step,
    Take,
    Track,
    check,
    fit,
    iterate,
    jacobian,
    refine,
    render,
)
from backlit._errors import Error, FileError, InputError

try:
    __version__ = version("backlit")
except PackageNotFoundError:
    __version__ = "0"

__all__ = [
    "Body",
    "CameraGroup",
    "Error",
    "FileError",
    "Finding",
    "InputError",
    "Iterations",
    "Pose",
    "Refinement",
    "Step",
    "Take",
    "Track",
    "check",
    "fit",
    "iterate",
    "jacobian",
    "refine",
    "render",
]
