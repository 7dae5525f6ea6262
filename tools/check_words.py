# SPDX-License-Identifier: Apache-2.0
"""List what breaks the rules of the words: ``python tools/check_words.py [PATHS]``."""

import argparse
import os
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from tools.words.block import Block  # noqa: E402 - works as a script, without a package
from tools.words.code import c_blocks, html_blocks, python_blocks, script_blocks  # noqa: E402
from tools.words.markdown import markdown_blocks, text_lines  # noqa: E402
from tools.words.rules import MAX_CHARACTERS_OF_A_LINE, Fault, faults_of  # noqa: E402
from tools.words.summary import HEADER, Summary  # noqa: E402

RECORD = Path("tools/words.toml")
# Generated tables, and the work of others.
NOT_OURS = (
    "schemas/models/",
    "gateway/fronts/pages/vendor/",
    "unity_client/client/Runtime/Messages/Generated/",
    "docs/reference/messages.md",
    "docs/reference/services.md",
    *(f"unity_client/{one}/LICENSE.md" for one in ("client", "displays", "robots")),
)
SKIPPED_FOLDERS = {"node_modules", "__pycache__", "dist", "build", "site", "fixtures"}
# The strings of these are texts that a user meets.
HAVE_TEXTS = (
    *("gateway/", "gateway_sim/", "schemas/", "tools/"),
    *(f"unity_client/{one}/Runtime/" for one in ("client", "displays", "robots")),
    *(f"unity_client/{one}/Editor/" for one in ("client", "displays", "robots")),
)
HAVE_TEMPLATES = "schemas/generate/"
ENDINGS = (".md", ".py", ".js", ".mjs", ".cs", ".css", ".html", ".sh", "Makefile", "Dockerfile")


def files(root: Path, paths: Iterable[str]) -> list[str]:
    """Return the names of the files under *paths*, relative to *root*, that are checked."""
    found = set()
    for path in paths:
        if (root / path).is_file():
            found.add(path)
        for folder, folders, names in os.walk(root / path):
            folders[:] = [
                name for name in folders if name[0] != "." and name not in SKIPPED_FOLDERS
            ]
            found.update(os.path.relpath(Path(folder) / name, root) for name in names)
    names = (Path(os.path.normpath(name)).as_posix() for name in found)
    return sorted(name for name in names if name.endswith(ENDINGS) and not _is_skipped(name))


def _is_skipped(name: str) -> bool:
    return name.startswith(NOT_OURS)


def blocks_of(name: str, source: str) -> list[Block]:
    """Return what a person reads in a file."""
    has_texts = name.startswith(HAVE_TEXTS) and not name.startswith(HAVE_TEMPLATES)
    match name.rpartition(".")[2]:
        case "md":
            return markdown_blocks(source)
        case "py":
            return python_blocks(source, has_texts)
        case "js" | "mjs" | "cs" | "css":
            return c_blocks(source, has_texts)
        case "html":
            return html_blocks(source)
    return script_blocks(source)


def faults(name: str, source: str) -> list[Fault]:
    """Return each broken rule of a file, by line."""
    found = [fault for block in blocks_of(name, source) for fault in faults_of(block)]
    if name.endswith(".md"):
        found.extend(_long_lines(source))
    return sorted(found)


def _long_lines(source: str) -> Iterator[Fault]:
    for number, line in text_lines(source):
        is_prose = not line.lstrip().startswith("|") and " " in line[:MAX_CHARACTERS_OF_A_LINE]
        if is_prose and len(line) > MAX_CHARACTERS_OF_A_LINE:
            yield Fault(number, "line", f"{len(line)} characters")


def count(root: Path, names: Iterable[str]) -> dict[str, Counter[str]]:
    """Return how often each file breaks each rule. Files without a fault are left out."""
    counts = {
        name: Counter(fault.rule for fault in faults(name, (root / name).read_text("utf-8")))
        for name in names
    }
    return {name: counter for name, counter in counts.items() if counter}


def recorded(root: Path) -> dict[str, dict[str, int]]:
    """Return how often each file may break each rule."""
    path = root / RECORD
    return tomllib.loads(path.read_text("utf-8")) if path.exists() else {}


def lowered(
    old: dict[str, dict[str, int]], new: dict[str, Counter[str]]
) -> dict[str, dict[str, int]]:
    """Return the record with what has become less. It never rises."""
    return {
        name: {rule: min(limit, new[name][rule]) for rule, limit in rules.items()}
        for name, rules in old.items()
        if name in new
    }


def as_toml(record: dict[str, dict[str, int]]) -> str:
    """Return the text of the record, without counts of 0."""
    lines = ["# How often each file breaks a rule of the words. `make docs` lowers it.\n"]
    for name, rules in sorted(record.items()):
        entries = [f"{rule} = {number}" for rule, number in sorted(rules.items()) if number]
        if entries:
            lines.append(f'"{name}" = {{ {", ".join(entries)} }}\n')
    return "".join(lines)


def show_faults(root: Path, names: Iterable[str]) -> int:
    """Print each fault and, at the end, how many there are of each rule. Return 1 if any."""
    totals: Counter[str] = Counter()
    for name in names:
        for fault in faults(name, (root / name).read_text("utf-8")):
            print(f"{name}:{fault.line}: {fault.rule}: {fault.text}")
            totals[fault.rule] += 1
    print(", ".join(f"{rule} {number}" for rule, number in totals.most_common()) or "no faults")
    return bool(totals)


def show_summary(root: Path, names: Iterable[str]) -> None:
    """Print the figures of each file, and of all."""
    total = Summary()
    print(HEADER)
    for name in names:
        summary = Summary()
        summary.add(blocks_of(name, (root / name).read_text("utf-8")))
        total.merge(summary)
        print(f"{summary}  {name}")
    print(f"{total}  in all")


def main() -> int:
    """Run the command line. Return the exit code."""
    parser = argparse.ArgumentParser(description="Check the words that people read.")
    parser.add_argument("paths", nargs="*", metavar="PATH", help="a file or directory (all)")
    parser.add_argument("--summary", action="store_true", help="print figures instead of faults")
    parser.add_argument("--update", action="store_true", help=f"lower the counts in {RECORD}")
    parser.add_argument("--initial", action="store_true", help="with --update: write all counts")
    parser.add_argument("--root", type=Path, default=REPOSITORY, help=argparse.SUPPRESS)
    options = parser.parse_args()
    root = options.root.resolve()
    here = (os.path.relpath(Path(path).resolve(), root) for path in options.paths)
    names = files(root, list(here) or ["."])
    if options.summary:
        show_summary(root, names)
    elif options.update:
        counts = count(root, files(root, ["."]))
        record = dict(counts) if options.initial else lowered(recorded(root), counts)
        (root / RECORD).write_text(as_toml(record), "utf-8")
    else:
        return show_faults(root, names)
    return 0


if __name__ == "__main__":
    sys.exit(main())
