"""What the test of the workflow expects of its results."""

import csv
import json
import re
import sys
from pathlib import Path

# Where both tracks hold a joint, this share of all is this near; the worst is a joint whose place hardly shows, in a single frame.
NEAR_MM, NEAR_SHARE = 1.0, 0.99


def check(is_met, message):
    if not is_met:
        sys.exit(f"FAILED: {message}")


def frames_of(track):
    return {frame["frame"]: frame for frame in json.loads((track / "track.json").read_text())["frames"]}


def holds(frame, limb):
    """Whether a track holds a limb in a frame: neither is the frame lost nor the limb doubtful."""
    return not frame["lost"] and frame["trust"].get(limb, {"verdict": "good"})["verdict"] == "good"


def whole(folder, count):
    results = folder / "results"
    pieces, one = frames_of(results / "simulated" / "track"), frames_of(folder / "whole")
    check(sorted(pieces) == list(range(count)), f"{len(pieces)} of {count} frames")
    held, near, worst = 0, 0, (0.0, "nothing")
    with open(folder / "beside" / "errors.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        number, limb = int(row["frame"]), row["joint"]
        if holds(pieces[number], limb) and holds(one[number], limb):
            apart = float(row["raw_mm"])
            held, near = held + 1, near + (apart <= NEAR_MM)
            worst = max(worst, (apart, f"{limb} in frame {number}"))
    summary = json.loads((results / "simulated" / "track" / "summary.json").read_text())
    print(f"{held} of {len(rows)} joints are held by both, {100 * near / held:.2f} % of them within {NEAR_MM} mm")
    print(f"farthest apart: {worst[0]:.1f} mm, {worst[1]}; pieces meet within {max(seam['apart_mm'] for seam in summary['seams']):.3f} mm")
    check(held > 0.9 * len(rows), "hardly a joint is held by both")
    check(near > NEAR_SHARE * held, "pieces and whole differ")
    check(all(seam["meets"] for seam in summary["seams"]), "pieces do not meet")
    index = (results / "index.html").read_text()
    rows = re.findall(r'<th scope="row">(.*?)</th>', index)
    check(sorted(rows) == ["built-in", "simulated"], f"the index has {rows}")


def slurm(folder):
    jobs = [json.loads(path.read_text()) for path in sorted((folder / "slurm").glob("*.json"))]
    rules = {job["comment"].split("_wildcards_")[0].removeprefix("rule_"): job["options"] for job in jobs}
    print(f"{len(jobs)} jobs of {sorted(rules)}")
    check({"check", "body", "track", "join", "export", "page"} <= rules.keys(), "a rule has no job")
    track = " ".join(rules["track"])
    for option in ("--mem 8000", "-t 720", "--cpus-per-task=4", "-p main"):
        check(option in track, f"{option} is not among the options of a track's job: {track}")
    script = next(job["script"] for job in jobs if "rule_track" in job["comment"])
    check("--executor slurm-jobstep" in script and "track:take=built-in" in script, script)
    check((folder / "results" / "built-in" / "page.html").is_file(), "the jobs made no page")


if __name__ == "__main__":
    if sys.argv[2] == "--slurm":
        slurm(Path(sys.argv[1]))
    else:
        whole(Path(sys.argv[1]), int(sys.argv[2]))
