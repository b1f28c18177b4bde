"""One page of all takes, worst first: what failed and why, what is doubtful, what is good."""

import argparse
import glob
import html
import json
import re
from dataclasses import dataclass
from pathlib import Path

# Exit codes of steps.
BAD_INPUT = (1, 2)
STATES = ("fault", "bad input", "missing", "doubtful", "good")
NUMBERS = ("frames", "lost", "doubtful limbs, %", "overlap (IoU)", "error, mm", "placed, mm", "joined within, mm")


@dataclass
class Row:
    """What is told of a take."""

    take: str
    state: str
    why: str
    numbers: dict
    cameras: str
    links: list

    def key(self):
        """Worst first: by state, then lost frames, doubtful limbs, overlap."""
        lost = self.numbers.get("lost", 0) / max(self.numbers.get("frames", 1), 1)
        doubtful, iou = self.numbers.get("doubtful limbs, %", 0), self.numbers.get("overlap (IoU)", 0)
        return STATES.index(self.state), -lost, -doubtful, iou, self.take


def read(path):
    """The JSON of a file, nothing where it is not there."""
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def failure(logs):
    """The exit code of the first step that failed, and what it said; nothing where none did."""
    for log in sorted(logs, key=lambda log: log.stat().st_mtime):
        text = log.read_text(encoding="utf-8", errors="replace")
        ended = re.search(r"^exit code (\d+)\n?\Z", text, re.M)
        if ended:
            said = [line.strip() for line in text.splitlines()[:-1] if line.strip()]
            errors = [line.removeprefix("error: ") for line in said if line.startswith("error: ")]
            message = (errors or said or ["it said nothing"])[-1]
            return int(ended[1]), f"{log.stem}: {message}"
    return None


def cameras_text(check):
    """What was found of the cameras."""
    if "findings" not in check:
        return ""
    names = [f"{finding['camera'] or 'a camera'}: {finding['kind']}" for finding in check["findings"]]
    return "; ".join(names) or "agree"


def row(results, take, person):
    """What became of a take."""
    folder = results / take
    check, track = read(folder / "cameras.json"), read(folder / "track" / "summary.json")
    numbers = {}
    if track:
        limbs = [count["doubtful"] + count["wrong"] for count in track["trust"].values()]
        numbers = {"frames": track["frames"], "lost": track["lost"]}
        numbers["doubtful limbs, %"] = 100 * max(limbs, default=0) / max(track["frames"], 1)
        numbers["overlap (IoU)"] = track["iou"]["mean"]
        seams = [seam["apart_mm"] for seam in track.get("seams", [])]
        numbers["joined within, mm"] = max(seams, default=None)
    compared = read(folder / "compared" / "comparison.json")
    errors = (compared[0]["joint_error_mm"] if compared else None) or {}
    numbers["error, mm"] = (errors.get("raw") or {}).get("mean")
    numbers["placed, mm"] = errors.get("placed")
    numbers = {name: value for name, value in numbers.items() if value is not None}
    logs = [*(folder / "logs").glob("*.log"), *(results / "people").glob(f"{glob.escape(person)}.log")]
    failed = failure(logs)
    if failed:
        state, why = "bad input" if failed[0] in BAD_INPUT else "fault", failed[1]
    elif not (folder / "page.html").is_file():
        state, why = "missing", "not all steps are done"
    elif "doubtful" in track:
        state, why = "doubtful", track["doubtful"]
    else:
        state, why = "good", ""
    files = {"page": "page.html", "motion": "motion", "comparison": "compared/comparison.json", "logs": "logs"}
    links = [(name, f"{take}/{file}") for name, file in files.items() if (folder / file).exists()]
    return Row(take, state, why, numbers, cameras_text(check), links)


STYLE = """
:root { color-scheme: light dark; --line: light-dark(#d0d4da, #3a4048); --quiet: light-dark(#555c66, #a8b0ba); }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem; }
table { border-collapse: collapse; }
th, td { padding: .4rem .8rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
thead th { color: var(--quiet); font-weight: 500; }
.number { text-align: right; font-variant-numeric: tabular-nums; }
.why { color: var(--quiet); max-width: 26rem; overflow-wrap: anywhere; }
.fault, .bad { color: light-dark(#b3261e, #ff8a80); } .doubtful, .missing { color: light-dark(#8a5a00, #f2b84b); }
.good { color: light-dark(#1b6e3c, #7bd89a); }
"""


def number(name, value):
    """A number as it is shown."""
    if name in ("frames", "lost"):
        return str(value)
    return f"{value:.3f}" if "IoU" in name else f"{value:.1f}"


def page(rows):
    """The whole page."""
    shown = [name for name in NUMBERS if any(name in row.numbers for row in rows)]
    heads = "".join(f'<th scope="col" class="number">{html.escape(name)}</th>' for name in shown)
    lines = []
    for one in rows:
        cells = []
        for name in shown:
            text = number(name, one.numbers[name]) if name in one.numbers else "–"
            cells.append(f'<td class="number">{text}</td>')
        links = " · ".join(f'<a href="{html.escape(path)}">{name}</a>' for name, path in one.links)
        why = f'<div class="why">{html.escape(one.why)}</div>' if one.why else ""
        lines.append(
            f'<tr><th scope="row">{html.escape(one.take)}</th>'
            f'<td><span class="{one.state.split()[0]}">{one.state}</span>{why}</td>{"".join(cells)}'
            f"<td>{html.escape(one.cameras)}</td><td>{links}</td></tr>"
        )
    counts = {state: sum(row.state == state for row in rows) for state in STATES}
    told = ", ".join(f"{count} {state}" for state, count in counts.items() if count)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Takes</title><style>{STYLE}</style></head><body>
<h1>Takes</h1><p>{told}. The worst come first.</p>
<table><thead><tr><th scope="col">take</th><th scope="col">result</th>{heads}<th scope="col">cameras</th><th scope="col">files</th></tr></thead>
<tbody>
{chr(10).join(lines)}
</tbody></table></body></html>
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("--takes", nargs="+", required=True, metavar="TAKE:PERSON")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    rows = sorted((row(arguments.results, *take.split(":")) for take in arguments.takes), key=Row.key)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    part = arguments.out.with_suffix(".part")
    part.write_text(page(rows), encoding="utf-8")
    part.replace(arguments.out)


if __name__ == "__main__":
    main()
