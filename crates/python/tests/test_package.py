"""The package itself: docstrings, stubs, types, the command line, examples."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import backlit as bl
from backlit import _backlit

from .conftest import backlit

HERE = Path(__file__).parent
EXAMPLES = HERE.parent / "examples"
PACKAGE = Path(bl.__file__).parent


def members(thing: object) -> list[str]:
    return [name for name in vars(thing) if not name.startswith("_")]


def test_every_public_name_is_documented() -> None:
    for name in bl.__all__:
        thing = getattr(bl, name)
        assert thing.__doc__, name
        for member in members(thing) if isinstance(thing, type) else []:
            assert getattr(thing, member).__doc__, f"{name}.{member}"
    assert sorted(name for name in members(_backlit) if name != "run_program") == sorted(
        name for name in bl.__all__ if not name.endswith("Error")
    )


def test_stubs_name_what_there_is() -> None:
    assert (PACKAGE / "py.typed").is_file()
    stubs = ast.parse((PACKAGE / "_backlit.pyi").read_text())
    classes = {node.name: node for node in stubs.body if isinstance(node, ast.ClassDef)}
    functions = {node.name: node for node in stubs.body if isinstance(node, ast.FunctionDef)}
    assert sorted([*classes, *functions]) == sorted(members(_backlit))
    for name, node in classes.items():
        stubbed = {one.name for one in node.body if isinstance(one, ast.FunctionDef) and not one.name.startswith("_")}
        assert stubbed == set(members(getattr(_backlit, name))), name
    for name, stub in functions.items():
        arguments = [one.arg for one in [*stub.args.args, *stub.args.kwonlyargs]]
        signature = getattr(_backlit, name).__text_signature__
        told = [word.split("=")[0].strip() for word in signature.strip("()").split(",")]
        assert [word for word in told if word.isidentifier()] == arguments, name


def test_types_are_strict() -> None:
    pytest.importorskip("mypy")
    configuration = HERE.parent / "pyproject.toml"
    files = [str(EXAMPLES / "fit.py"), str(EXAMPLES / "convergence.py"), str(EXAMPLES / "masks_mediapipe.py")]
    mypy = [sys.executable, "-m", "mypy", "--cache-dir", os.devnull, "--config-file", str(configuration)]
    for words in (["-p", "backlit"], files):
        done = subprocess.run([*mypy, *words], capture_output=True, text=True, cwd=HERE)
        assert done.returncode == 0, done.stdout


def test_the_command_line() -> None:
    done = backlit("--help")
    assert done.returncode == 0 and "track" in done.stdout and "refine-cameras" in done.stdout
    done = backlit("--version")
    assert done.returncode == 0 and done.stdout.startswith("backlit ")
    for words in ([], ["screenshot", "--out", "a.png"]):
        done = backlit(*words)
        assert done.returncode == 1 and "the window is in the program backlit, not in the Python package" in done.stderr
    done = backlit("trak")
    assert done.returncode == 2 and '"trak" is neither a command' in done.stderr
    assert backlit("track").returncode == 2
    done = backlit("cameras", "nowhere.toml")
    assert done.returncode == 1 and done.stderr == "error: nowhere.toml: there is no such file\n"
    done = subprocess.run([sys.executable, "-m", "backlit", "--version"], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("backlit ")


@pytest.mark.parametrize("name", ["fit", "convergence"])
def test_examples_run(name: str, tmp_path: Path) -> None:
    if name == "convergence":
        pytest.importorskip("matplotlib")
    done = subprocess.run([sys.executable, EXAMPLES / f"{name}.py"], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.iterdir()), "it writes files"


def test_examples_are_short() -> None:
    for path in EXAMPLES.glob("*.py"):
        assert len(path.read_text().splitlines()) <= 30, path.name
