# The takes and their settings, and in which pieces a take is tracked.
import csv
import json
import shlex
import sys
from pathlib import Path

from snakemake.utils import validate

validate(config, "../schemas/config.schema.yaml")

SCRIPTS = Path(workflow.basedir) / "scripts"
# Runs a command with its messages in a log.
STEP = shlex.quote(str(SCRIPTS / "step"))
BACKLIT = config["backlit"]


def read_takes(path):
    """The rows of the table of takes, by name. Empty cells are left out."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = (line for line in file if line.strip() and not line.startswith("#"))
        rows = [{k: v for k, v in row.items() if v} for row in csv.DictReader(lines, delimiter="\t")]
    takes = {}
    for number, row in enumerate(rows, 1):
        validate(row, "../schemas/takes.schema.yaml")
        if row["take"] in takes:
            raise WorkflowError(f"{path}: row {number}: there is a take {row['take']} already")
        takes[row["take"]] = row
    if not takes:
        raise WorkflowError(f"{path}: there is no take")
    return takes


TAKES = read_takes(config["takes"])
# Who is in each take, and the takes of each person.
PERSON = {name: row.get("person", name) for name, row in TAKES.items()}
PEOPLE = {person: [name for name in TAKES if PERSON[name] == person] for person in PERSON.values()}


wildcard_constraints:
    take=r"[A-Za-z0-9_.-]+",
    person=r"[A-Za-z0-9_.-]+",
    first=r"\d+",
    past=r"\d+",


def row_of(wildcards):
    return TAKES[wildcards.take]


def is_ready(row):
    """Whether the source is a take already, which needs no import."""
    return (Path(row["source"]) / "take.toml").is_file()


def existing(path):
    """The path as an input. One that is not there fails its own step, not the whole workflow."""
    return [path] if path and Path(path).exists() else []


def take_folder(name):
    row = TAKES[name]
    return row["source"] if is_ready(row) else f"results/{name}/take"


def body_of(wildcards):
    """The file of the person's own body, where it is fitted."""
    return f"results/people/{PERSON[wildcards.take]}.toml" if config["body"] == "fit" else []


def model_option(wildcards):
    if config["body"] == "take":
        return ""
    return f"--model {shlex.quote(body_of(wildcards) or config['body'])}"


def spans(frames):
    """Pieces of a take: first frame and the one after the last. Neighbours overlap."""
    size, overlap = config["pieces"]["frames"], config["pieces"]["overlap"]
    if overlap >= size:
        raise WorkflowError("config: pieces: overlap must be smaller than frames")
    starts = range(0, max(frames - overlap, 1), size - overlap)
    return [(first, min(first + size, frames)) for first in starts]


def frames_of(check):
    """How many frames a take has, which has been checked."""
    with open(check, encoding="utf-8") as file:
        return json.load(file)["frames"]


def pieces(wildcards):
    """The tracks of a take's pieces; how many there are is known once the take has been checked."""
    frames = frames_of(checkpoints.check.get(take=wildcards.take).output[0])
    return [f"results/{wildcards.take}/pieces/{first}-{past}" for first, past in spans(frames)]


def reference(wildcards):
    return existing(row_of(wildcards).get("reference"))


def reference_path(wildcards):
    return shlex.quote(row_of(wildcards)["reference"])


def all_results(wildcards):
    """What is made of each take."""
    for name, row in TAKES.items():
        yield f"results/{name}/page.html"
        yield f"results/{name}/cameras.json"
        if config["export"]:
            yield f"results/{name}/motion"
        if "reference" in row:
            yield f"results/{name}/compared"


def index_command(name):
    """Writes the index of all takes to a file of this name."""
    takes = [f"{name}:{person}" for name, person in PERSON.items()]
    program = [sys.executable, str(SCRIPTS / "index.py"), "results", "--takes", *takes]
    return shlex.join([*program, "--out", f"results/{name}.html"])
