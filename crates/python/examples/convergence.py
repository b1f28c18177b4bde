"""How the cost falls with each of the three renderers from one start, as a picture."""

from typing import Final, Literal

import matplotlib
import numpy as np

import backlit as bl

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

RENDERERS: Final[tuple[Literal["capsule", "cylinder", "sphere_tree"], ...]] = ("capsule", "cylinder", "sphere_tree")

take = bl.Take.load()
assert take.start is not None
rotations = len(take.start.rotations)
start = take.start.moved(np.r_[0.04, 0.03, -0.03, 0.12 * np.cos(np.arange(3 * rotations))])

figure, axes = pyplot.subplots(figsize=(6, 4), layout="constrained")
for renderer in RENDERERS:
    fit = bl.iterate(take, start=start, preset="report", renderer=renderer, ramp="half", iterations=25)
    steps = list(fit)
    axes.semilogy([step.number for step in steps], [step.cost for step in steps], label=renderer.replace("_", " "))
    print(f"{renderer}: {steps[0].cost:.3g} to {steps[-1].cost:.3g}, {fit.termination}")
axes.set(xlabel="iteration", ylabel="cost, squared grey levels")
axes.legend()
figure.savefig("convergence.png", dpi=150)
