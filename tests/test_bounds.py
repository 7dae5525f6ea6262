# SPDX-License-Identifier: Apache-2.0
"""Every bound and rate is used, and `make mutants` changes its number.

A bound is a number with a unit, or with ``MAX`` or the like, in its name.
"""

import ast
import re
from collections import Counter
from typing import Final

import pytest

from tools.mutants.rules import mutants_of
from tools.mutants.selection import ROOT

UNITS: Final = ("S", "MS", "NS", "BYTES", "HZ", "PER_S")
EXTREMES: Final = ("MAX", "MOST", "MIN", "LEAST")
BOUND: Final = re.compile(rf"_?(?:(?:{'|'.join(EXTREMES)})_\w+|\w*_(?:{'|'.join(UNITS)})|PER_S)")
WORD: Final = re.compile(r"\b[A-Z0-9_]+\b")
FILES: Final = {
    path.relative_to(ROOT).as_posix(): path.read_text() for path in (ROOT / "gateway").rglob("*.py")
}


def bounds_of(source: str) -> list[str]:
    """Return the bounds that a module or a class defines by a number, in whatever way."""
    return [
        name
        for node in ast.walk(ast.parse(source))
        for name, value in [assigned(node)]
        if BOUND.fullmatch(name)
        and not isinstance(value, ast.Tuple)
        and any(
            isinstance(part, ast.Constant) and type(part.value) in {int, float}
            for part in ast.walk(value)
        )
    ]


def assigned(node: ast.AST) -> tuple[str, ast.AST]:
    match node:
        case ast.Assign([ast.Name(name)], value) | ast.AnnAssign(
            ast.Name(name), _, ast.expr() as value
        ):
            return name, value
    return "", node


def covered(source: str) -> set[str]:
    """Return the constants that a rule changes."""
    mutants = mutants_of("x.py", source.encode(), {"bound": ""})
    return {mutant.where.rpartition(".")[2] for mutant in mutants}


@pytest.fixture(scope="module")
def bounds() -> dict[str, list[str]]:
    return {file: found for file, source in FILES.items() if (found := bounds_of(source))}


def test_a_rule_changes_every_bound(bounds: dict[str, list[str]]):
    missing = {file: set(names) - covered(FILES[file]) for file, names in bounds.items()}
    lines = [f"{file}: {name}" for file, names in missing.items() for name in sorted(names)]
    assert not lines, "\n".join(["write `NAME: Final = NUMBER`, for `make mutants`:", *lines])


def test_every_bound_is_used(bounds: dict[str, list[str]]):
    words = Counter(word for source in FILES.values() for word in WORD.findall(source))
    lines = [
        f"{file}: {name}" for file, names in bounds.items() for name in names if words[name] < 2
    ]
    assert not lines, "\n".join(["remove what nothing uses:", *lines])


def test_a_bound_is_known_by_its_name_and_its_number():
    known = "MAX_X = 3\nA_BYTES: Final = 4 * KIB\nDUE_NS: Final = round(S / 4)\nREST_S = Time(3)"
    other = "LARGE_BYTES: Final = OTHER_BYTES\nPINGS: Final = 3\nKEPT_BYTES = b''"
    assert bounds_of(f"{known}\n{other}") == ["MAX_X", "A_BYTES", "DUE_NS", "REST_S"]
    assert covered(known) == {"MAX_X", "A_BYTES", "DUE_NS"}
