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


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page as GitHub names them."""
    text = page.read_text("utf-8")
    titles = re.findall(r"^#+ +(.+)$", text, re.MULTILINE)
    shown = (re.sub(r"\[(.+?)\]\(.+?\)", r"\1", title) for title in titles)
    named = {re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-") for title in shown}
    return named | set(re.findall(r"<a id=\"(.+?)\"", text))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_anchors_that_a_page_links_to_are_there(page: Path):
    links = re.findall(r"\]\(([^)#\s]*)#([^)\s]+)\)", page.read_text("utf-8"))
    ours = [(page.parent / target if target else page, anchor) for target, anchor in links]
    pages = [(target, anchor) for target, anchor in ours if target.suffix == ".md"]
    assert [f"{t}#{a}" for t, a in pages if t.exists() and a not in anchors(t)] == []
