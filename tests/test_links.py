# SPDX-License-Identifier: Apache-2.0
"""Links of the documents to files of this tree."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("changes", "docs", "docker", "benchmarks", "schemas", "unity_client")
PAGES = [
    *ROOT.glob("*.md"),
    *(page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md")),
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_linked_file_exists(page: Path):
    targets = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text("utf-8"))
    ours = [target for target in targets if ":" not in target]
    assert [target for target in ours if not (page.parent / target).exists()] == []
