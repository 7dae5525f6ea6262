# SPDX-License-Identifier: Apache-2.0
"""The packages' pages, and the packages that their readers have."""

from pathlib import Path
from typing import Final

from tests.unity.package import HOME, PACKAGES, installed_with

TUTORIAL: Final = HOME.parent / "docs/tutorials/unity.md"
PAGES: Final = [
    *sorted(HOME.glob("*/Documentation~/*.md")),
    *sorted(HOME.glob("*/Samples~/*/README.md")),
    TUTORIAL,
]


def installed_for(page: Path) -> set[Path]:
    """Return what a page's reader has: the packages that it names, and its own with its needs."""
    text = page.read_text("utf-8")
    named = {one for one in PACKAGES if f"unity_client/{one.name}" in text}
    own = [one for one in PACKAGES if one in page.parents]
    return named.union(*map(installed_with, own))
