"""A short recording of the built-in take, as arrays."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import backlit as bl

FRAMES = 6


@dataclass(frozen=True)
class Recording:
    """Six frames of four cameras."""

    cams: bl.CameraGroup
    masks: NDArray[np.uint8]
    start: bl.Pose
    body: bl.Body


@pytest.fixture(scope="session")
def recording() -> Recording:
    take = bl.Take.load()
    masks = np.stack([np.stack(take.masks(frame)) for frame in range(FRAMES)], axis=1)
    assert take.start is not None
    return Recording(take.ideal_cameras, masks, take.start, take.body)


def backlit(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the command line that came with the package."""
    program = Path(sys.executable).with_name("backlit")
    words = [str(program), *map(str, arguments)]
    environment = {**os.environ, "COLUMNS": "120"}
    return subprocess.run(words, capture_output=True, text=True, cwd=cwd, env=environment, timeout=600)
