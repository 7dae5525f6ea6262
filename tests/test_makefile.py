# SPDX-License-Identifier: Apache-2.0
"""The effects of `make` on files, with stand-ins for the programs that it calls."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TIMEOUT_S = 180


@pytest.fixture
def tree(tmp_path):
    """Return a source tree whose .venv is ready."""
    (tmp_path / "pyproject.toml").touch()
    (tmp_path / ".venv/bin").mkdir(parents=True)
    script(tmp_path, "python", "exit 0")
    for ready in (".ready", ".ready-for-tests"):
        (tmp_path / ".venv" / ready).touch()
    return tmp_path


def script(tree, name, lines):
    path = tree / ".venv/bin" / name
    path.write_text(f"#!/bin/sh\n{lines}\n")
    path.chmod(0o755)


@pytest.mark.parametrize(
    ("arguments", "selects"),
    [
        ((), "-m not long"),
        (("ALL=1",), ""),
        (("ARGS=tests/e2e/test_log.py -x",), "tests/e2e/test_log.py -x"),
        (("ARGS=-x",), "-m not long -x"),
    ],
    ids=["short", "all", "named", "options"],
)
def test_make_test_leaves_out_what_is_long_unless_it_is_asked_for(tree, arguments, selects):
    make = shutil.which("make")
    if make is None:
        pytest.skip("make is not installed")
    for name in ("ruff", "mypy", "lint-imports", "codespell", "pymarkdown"):
        script(tree, name, "exit 0")
    script(tree, "python", 'case "$2" in pytest) echo "runs: $*";; esac')
    (tree / "tools").mkdir()
    for name in ("make-clients", "make-mono", "make-browser", "make-balancers", "make-colcon"):
        (tree / f"tools/{name}.sh").touch()
    (tree / ".venv/clients").mkdir()
    (tree / ".venv/clients/.ready").touch()
    command = [make, "-f", str(ROOT / "Makefile"), "test", *arguments]
    # the make that runs these tests gives its own ALL and ARGS to all that run below it
    of_make = {"MAKEFLAGS", "MFLAGS", "MAKEOVERRIDES", "ALL", "ARGS"}
    environment = {name: value for name, value in os.environ.items() if name not in of_make}
    finished = subprocess.run(
        command,
        cwd=tree,
        env=environment,
        capture_output=True,
        timeout=TIMEOUT_S,
        check=True,
        text=True,
    )
    ran = [line for line in finished.stdout.splitlines() if line.startswith("runs: ")]
    assert [" ".join(line.split()) for line in ran] == [
        f"runs: -m pytest -n auto --dist worksteal {selects}".rstrip()
    ]


def test_a_tree_that_cannot_be_written_is_named_with_what_to_do(tmp_path):
    (tmp_path / ".venv").touch()  # which root cannot make a folder of, either
    for source in ("Makefile", "pyproject.toml"):
        shutil.copy(ROOT / source, tmp_path)
    (tmp_path / "tools").symlink_to(ROOT / "tools")
    make = shutil.which("make")
    if make is None:
        pytest.skip("make is not installed")
    finished = subprocess.run(
        [make, "demo"], cwd=tmp_path, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    assert finished.returncode != 0
    assert f"cannot write .venv in {tmp_path}: the tree is read-only" in finished.stderr
    assert f"cp -r '{tmp_path}' ~/ros2-json-gateway" in finished.stderr


def test_the_check_leaves_a_folder_as_it_was(tmp_path):
    (tmp_path / "there").mkdir()
    for name in ("there", "new"):
        command = ["sh", str(ROOT / "tools/check-writable.sh"), str(tmp_path / name)]
        assert subprocess.run(command, timeout=TIMEOUT_S, check=False).returncode == 0
    assert not (tmp_path / "new").exists()
    assert not (tmp_path / "there").exists() or not list((tmp_path / "there").iterdir())
