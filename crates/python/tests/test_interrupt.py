"""Long work lets Python run: Ctrl+C ends it, other threads go on, progress is told."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import backlit as bl

from .conftest import Recording

LONG = 2_000


def long_masks(recording: Recording) -> np.ndarray:
    return np.broadcast_to(recording.masks[:, :1], (len(recording.cams), LONG, *recording.masks.shape[2:]))


@pytest.fixture
def hears_ctrl_c() -> Iterator[None]:
    """Python's own handler: what runs in the background is born deaf to Ctrl+C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("hears_ctrl_c")
@pytest.mark.parametrize("threads", [None, 1])
def test_ctrl_c_raises_and_other_threads_run(recording: Recording, threads: int | None) -> None:
    take = bl.Take.from_arrays(recording.cams, long_masks(recording), body=recording.body, start=recording.start)
    counted, pressed = 0, 0.0
    ends = threading.Event()

    def other() -> None:
        nonlocal counted, pressed
        began = time.monotonic()
        while not ends.is_set():
            counted += 1
            time.sleep(0.001)
            if not pressed and time.monotonic() - began > 1.0:
                pressed = time.monotonic()
                os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=other)
    thread.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            bl.fit(take, n_threads=threads)
        late = time.monotonic() - pressed
    finally:
        ends.set()
        thread.join()
    assert late < 2.0, f"{late:.2f} s"
    # With the interpreter held, the other thread would have counted next to nothing.
    assert counted > 200
    # What was borrowed can be used again.
    assert len(bl.fit(take, frames=[0, 1])) == 2


def test_progress_is_told_and_may_stop_the_work(recording: Recording) -> None:
    told: list[tuple[int, int, str]] = []
    bl.fit(recording.cams, recording.masks, body=recording.body, start=recording.start, progress=lambda *news: told.append(news))
    assert told[-1] == (6, 6, "6 of 6 frames tracked")

    def stop(done: int, _all: int, _text: str) -> None:
        if done > 3:
            raise StopAsyncIteration("enough")

    with pytest.raises(StopAsyncIteration, match="enough"):
        bl.fit(recording.cams, long_masks(recording), body=recording.body, start=recording.start, progress=stop)


def test_ctrl_c_ends_the_command_line(recording: Recording, tmp_path: Path) -> None:
    masks = np.repeat(recording.masks[:, :1], 300, axis=1)
    bl.Take.from_arrays(recording.cams, masks, body=recording.body, start=recording.start).save(tmp_path / "take")
    program = str(Path(sys.executable).with_name("backlit"))
    work = subprocess.Popen([program, "track", "take", "--out", "out"], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    work.send_signal(signal.SIGINT)
    _, said = work.communicate(timeout=60)
    assert work.returncode == 130 and "stopped by Ctrl+C" in said
