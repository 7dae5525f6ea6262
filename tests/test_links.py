# SPDX-License-Identifier: Apache-2.0
"""Links of the documents to files of this tree."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ("changes", "docs", "docker", "benchmarks", "schemas", "unity_client")
PAGES = [
    *ROOT.glob("*.md"),
    *(page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md")),
]


def test_every_linked_file_exists():
    targets = [
        (page, target)
        for page in PAGES
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text("utf-8"))
    ]
    ours = [(page, target) for page, target in targets if ":" not in target]
    assert [f"{p.relative_to(ROOT)}: {t}" for p, t in ours if not (p.parent / t).exists()] == []


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page as GitHub names them."""
    text = page.read_text("utf-8")
    titles = re.findall(r"^#+ +(.+)$", text, re.MULTILINE)
    shown = (re.sub(r"\[(.+?)\]\(.+?\)", r"\1", title) for title in titles)
    named = {re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-") for title in shown}
    return named | set(re.findall(r"<a id=\"(.+?)\"", text))


def test_the_anchors_that_a_page_links_to_are_there():
    links = [
        (page, page.parent / target if target else page, anchor)
        for page in PAGES
        for target, anchor in re.findall(r"\]\(([^)#\s]*)#([^)\s]+)\)", page.read_text("utf-8"))
    ]
    ours = [(page, to, anchor) for page, to, anchor in links if to.suffix == ".md" and to.exists()]
    there = {to: anchors(to) for _, to, _ in ours}
    assert [f"{p.relative_to(ROOT)}: {t.name}#{a}" for p, t, a in ours if a not in there[t]] == []
