# SPDX-License-Identifier: Apache-2.0
"""The changelogs, and the lines in `changes/` that a release moves to them."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAX_WORDS = 20
MAX_LINES_OF_A_RELEASE = 25
VERBS = {"added": "Add", "changed": "Change", "fixed": "Fix", "removed": "Remove"}
FRAGMENTS = sorted(
    path
    for path in (ROOT / "changes").rglob("*")
    if path.suffix != ".toml" and path.is_file() and path.name != "README.md"
)
CHANGELOGS = [ROOT / "CHANGELOG.md", ROOT / "unity_client/client/CHANGELOG.md"]


def words(line: str) -> int:
    """Count the words that a reader sees, without the addresses of links."""
    return len(re.sub(r"\]\([^)]*\)", "]", line).split())


def test_a_change_is_one_short_line_that_starts_with_its_verb():
    for path in FRAGMENTS:
        name = re.fullmatch(r"\+[\w-]+\.(added|changed|fixed|removed)\.md", path.name)
        assert name, f"name {path.name} +NAME.TYPE.md, see CONTRIBUTING.md"
        (line,) = path.read_text("utf-8").splitlines()
        assert line.split()[0] == VERBS[name[1]], path.name
        assert words(line) <= MAX_WORDS, path.name


@pytest.mark.parametrize("path", CHANGELOGS, ids=lambda path: path.parent.name)
def test_a_release_is_a_short_list_of_such_lines(path: Path):
    _, *releases = re.split(r"^## ", path.read_text("utf-8"), flags=re.MULTILINE)
    assert releases
    for release in releases:
        _, *lines = re.split(r"^- ", release, flags=re.MULTILINE)
        assert 0 < len(lines) <= MAX_LINES_OF_A_RELEASE
        assert [line for line in lines if line.split()[0] not in VERBS.values()] == []
        assert [line for line in lines if words(line) > MAX_WORDS] == []
