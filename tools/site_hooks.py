# SPDX-License-Identifier: Apache-2.0
"""Hooks of `make site`: add the pages outside `docs/`, and load no script from another host."""

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
# Directories of the tree, and the place of their pages in the site. The first that fits counts.
PLACES = {
    "docs/": "",
    "unity_client/client/Documentation~/": "unity/",
    "unity_client/client/Samples~/": "unity/",
    "unity_client/client/": "unity/client/",
    "unity_client/displays/Documentation~/": "unity/",
    "unity_client/displays/Samples~/": "unity/",
    "unity_client/displays/": "unity/displays/",
    "unity_client/robots/Documentation~/": "unity/",
    "unity_client/robots/Samples~/": "unity/",
    "unity_client/robots/": "unity/robots/",
}
OUTSIDE_DOCS = (
    "*.md",
    "docker/*.md",
    "benchmarks/**/*.md",
    "schemas/definitions/*.md",
    "unity_client/**/*.md",
    "unity_client/*/Documentation~/**/*.png",
)
MERMAID = (
    Path(sys.prefix) / "clients/mermaid-11.17.2/node_modules/@mermaid-js/tiny/dist/mermaid.tiny.js"
)
MERMAID_IN_SITE = "assets/javascripts/mermaid.js"
# The theme loads these from another host. Every browser since 2020 has the second one built in.
REMOTE_SCRIPTS = {
    r'"https://[^"]+/mermaid\.min\.js"': f'new URL("{MERMAID_IN_SITE}",__md_scope).href',
    r'"https://[^"]+/resize-observer-polyfill"': '"data:text/javascript,"',
}
_ITEM = re.compile(r" {0,3}(?:[-*+]|\d+[.)]) +")
_LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|!\[[^\]]*\]\([^)]*\))+)\]\(([^)#\s]+)(#[^)\s]*)?\)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Name every file by its path in the tree, so that links between all of them hold."""
    of_theme = [file for file in files if file.src_dir != config.docs_dir]
    return Files([*of_theme, *(_file(path, config) for path in sorted(_sources()))])


def _sources() -> Iterator[str]:
    for pattern in ("docs/**/*.*", *OUTSIDE_DOCS):
        for path in ROOT.glob(pattern):
            if path.is_file() and path.name != "LICENSE.md":
                yield path.relative_to(ROOT).as_posix()


def _file(path: str, config: MkDocsConfig) -> File:
    start = next((start for start in PLACES if path.startswith(start)), "")
    place = PLACES.get(start, "") + path.removeprefix(start)
    if path == "README.md":  # else it would be the first page
        place = "readme.md"
    return File(
        path,
        str(ROOT),
        config.site_dir,
        config.use_directory_urls,
        dest_uri=File(place, None, config.site_dir, config.use_directory_urls).dest_uri,
    )


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Reduce a link to its text if it leads to a file that the site lacks, such as code."""
    del config
    folder = Path(page.file.src_uri).parent

    def without_code(match: re.Match[str]) -> str:
        target = os.path.normpath(folder / match[2])
        is_code = (ROOT / target).exists() and target not in files.src_uris
        return match[1] if is_code else match[0]

    return indented_by_four(_LINK.sub(without_code, markdown))


def indented_by_four(markdown: str) -> str:
    """Indent what belongs to a list item by four spaces, which Python-Markdown needs."""
    written: list[str] = []
    columns: list[int] = []  # at which the text of each open item starts
    fence = ""
    for line in markdown.splitlines():
        indent = len(line) - len(line.lstrip())
        while not fence and line.strip() and columns and indent < columns[-1]:
            columns.pop()
        column = columns[-1] if columns else 0
        text = line[min(indent, column) :]
        written.append(" " * 4 * len(columns) + text if text else "")
        marker = text.lstrip()[:3]
        if fence:
            fence = "" if marker == fence else fence
        elif marker in {"```", "~~~"}:
            fence = marker
        elif item := _ITEM.match(text):
            columns.append(column + len(item[0]))
    return "\n".join(written) + "\n"


def on_post_build(config: MkDocsConfig) -> None:
    """Load the scripts of the theme from the site."""
    site = Path(config.site_dir)
    if not MERMAID.exists():
        raise PluginError(f"{MERMAID} is missing: run `make site`, which installs it")
    (site / MERMAID_IN_SITE).write_bytes(MERMAID.read_bytes())
    (bundle,) = site.glob("assets/javascripts/bundle.*.min.js")
    code = bundle.read_text("utf-8")
    for remote, local in REMOTE_SCRIPTS.items():
        code, found = re.subn(remote, local, code)
        if found != 1:
            raise PluginError(f"the theme no longer loads {remote}: see tools/site_hooks.py")
    bundle.write_text(code, "utf-8")
