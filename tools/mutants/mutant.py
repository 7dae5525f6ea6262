# SPDX-License-Identifier: Apache-2.0
"""The list of mutants: which line is broken how, and which tests must notice."""

import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).parents[2]
FOLDER: Final = Path(__file__).parent

_PAGE: Final = """\
# Mutants

After this page you can check that tests notice a broken line, and add an entry for a new limit.

`make mutants` breaks one line of code at a time, in a copy of the tree, and runs the tests of it.
Run it in the directory of the repository. `make mutants WHAT=codec` takes the entries whose path or
rule contains that word.

If no test notices a mutant, it survives. Then write the missing test, or add a reason to the entry.
The command fails if fewer than {share:.0%} are killed, or if a survivor has no reason.

The entries are in `tools/mutants/*.toml`. Each has a file, a rule, a line, and the broken line.
If you change such a line, change its entry. `tests/tools/test_mutants.py` checks this.
`make docs` writes this page.

| Package | Mutants | Expected to survive |
|---|---|---|
{counts}

## Survivors

{survivors}
"""


class MutantError(Exception):
    """Raised when the list does not fit the code. The text says which entry and why."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """One broken line: *old*, which occurs once in *file*, becomes *new*.

    *rule* is what the line keeps, and *survives* why no test notices, if none does.
    """

    file: str
    rule: str
    old: str
    new: str
    tests: tuple[str, ...]
    survives: str | None = None

    def broken(self, root: Path) -> str:
        """Return the text of the file below *root* with the line broken.

        Raises:
            MutantError: the line is missing or occurs more than once, or the result is not Python.
        """
        text = (root / self.file).read_text()
        count = text.count(self.old)
        if count != 1:
            raise MutantError(
                f"{self.file}: {self.rule}: the line has changed, update the list: expected"
                f" {self.old!r} once, found it {count} times"
            )
        broken = text.replace(self.old, self.new)
        try:
            compile(broken, self.file, "exec")
        except SyntaxError as error:
            raise MutantError(f"{self.file}: {self.rule}: {error}") from None
        return broken


def load(tables: Iterable[Path] | None = None, root: Path = ROOT) -> list[Mutant]:
    """Read the list, by default all of it.

    Raises:
        MutantError: an entry is incomplete, or names no test that there is.
    """
    paths = sorted(FOLDER.glob("*.toml")) if tables is None else tables
    return [mutant for path in paths for mutant in _of_table(path, root)]


def page(mutants: Sequence[Mutant], share: float) -> str:
    """Return docs/contributing/mutants.md."""
    packages = sorted({_package(mutant) for mutant in mutants})
    counts = []
    for package in packages:
        of_package = [mutant for mutant in mutants if _package(mutant) == package]
        surviving = sum(mutant.survives is not None for mutant in of_package)
        counts.append(f"| `{package}` | {len(of_package)} | {surviving} |")
    survivors = [
        f"- `{mutant.file}`, {mutant.rule}:\n  {mutant.survives}"
        for mutant in mutants
        if mutant.survives is not None
    ]
    return _PAGE.format(
        share=share, counts="\n".join(counts), survivors="\n".join(survivors) or "None."
    )


def _of_table(path: Path, root: Path) -> list[Mutant]:
    table = tomllib.loads(path.read_text())
    tests = table.pop("tests", {})
    found = []
    for file, entries in table.items():
        own = tests.pop(file, None)
        found += [_mutant(path, file, entry, own, root) for entry in entries]
    if tests:
        raise MutantError(f"{path.name}: tests of files without mutants: {', '.join(tests)}")
    return found


def _mutant(
    path: Path, file: str, entry: dict[str, Any], own: list[str] | None, root: Path
) -> Mutant:
    where = f"{path.name}: {file}: {entry.get('rule')}"
    unknown = entry.keys() - {"rule", "old", "new", "tests", "survives"}
    missing = {"rule", "old", "new"} - entry.keys()
    if unknown or missing:
        raise MutantError(f"{where}: unknown {sorted(unknown)}, missing {sorted(missing)}")
    if entry["old"] == entry["new"]:
        raise MutantError(f"{where}: nothing is broken")
    tests = tuple(entry.get("tests") or own or [_mirror(file)])
    for test in tests:
        if not (root / test.partition("::")[0]).exists():
            raise MutantError(f"{where}: there is no {test}, name its tests")
    if not (root / file).exists():
        raise MutantError(f"{where}: there is no such file")
    return Mutant(file, entry["rule"], entry["old"], entry["new"], tests, entry.get("survives"))


def _mirror(file: str) -> str:
    """Return the test of a file: `gateway/x/y.py` has `tests/x/test_y.py`."""
    path = Path(file)
    folder = Path(*path.parts[1:-1]) if path.parts[0] == "gateway" else path.parent
    return str(Path("tests", folder, f"test_{path.name}"))


def _package(mutant: Mutant) -> str:
    parts = Path(mutant.file).parts
    return "/".join(parts[:2]) if parts[0] == "gateway" else parts[0]
