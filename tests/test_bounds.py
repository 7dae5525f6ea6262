# SPDX-License-Identifier: Apache-2.0
"""Every bound and rate has a test that fails where it is another: a mutant changes each of them.

A bound is a number with a unit, or with ``MAX`` or the like, in its name. A mutant that breaks only
the line where it is used shows that there is a bound, and not that it is the one that is promised.
"""

import ast
import re
from collections.abc import Iterator
from typing import Final, NamedTuple

import pytest

from tools.mutants.mutant import ROOT, Mutant, load

UNITS: Final = ("S", "MS", "NS", "BYTES", "HZ", "PER_S")
EXTREMES: Final = ("MAX", "MOST", "MIN", "LEAST")
BOUND: Final = re.compile(rf"_?(?:(?:{'|'.join(EXTREMES)})_\w+|\w*_(?:{'|'.join(UNITS)})|PER_S)")
DEFINITION: Final = re.compile(r"^(\w+): Final\b(.*)", re.MULTILINE)


class Bound(NamedTuple):
    """A constant at the top of a file."""

    file: str
    name: str

    def __str__(self) -> str:
        return f"{self.file}: {self.name}"


# Constants with such a name that bound nothing, and why.
NO_BOUNDS: Final = {
    Bound("gateway/codec/cdr/rows.py", "_FLOAT32_BYTES"): "a size of CDR",
    Bound("gateway/sources/rclpy/action_forms.py", "_STATUS_BYTES"): "a size of CDR",
    Bound("gateway/sources/rclpy/realignment.py", "_COUNT_BYTES"): "a size of CDR",
    Bound("gateway/codec/compressed_images.py", "_PNG_CHECKSUM_BYTES"): "a size of PNG",
    Bound("gateway/transport/link.py", "_NS_PER_S"): "a unit in another",
    Bound(
        "gateway/sources/rclpy/rclpy_private/handles.py", "SPIN_S"
    ): "stands for no time-out at all",
}


def bounds_of(file: str, source: str) -> Iterator[Bound]:
    """Yield the bounds that a module defines at its top."""
    for node in ast.parse(source).body:
        match node:
            case ast.AnnAssign(ast.Name(name), annotation, value) if (
                BOUND.fullmatch(name) and is_final(annotation) and is_number(value)
            ):
                yield Bound(file, name)


def is_final(annotation: ast.expr) -> bool:
    return ast.unparse(annotation).partition("[")[0] == "Final"


def is_number(value: ast.expr | None) -> bool:
    """Return whether it is a number, or computed of one. A mere name is another's number."""
    match value:
        case ast.Constant(int() | float()):
            return True
        case ast.UnaryOp(_, operand):
            return is_number(operand)
        case ast.BinOp(left, _, right):
            return is_number(left) or is_number(right)
        case ast.Call(ast.Name("round" | "int" | "float"), arguments):
            return any(map(is_number, arguments))
        case _:
            return False


def named_by_mutant(mutant: Mutant) -> set[Bound]:
    return {Bound(mutant.file, name) for name in re.findall(r"\w+", mutant.old)}


def changed_by_mutant(mutant: Mutant) -> set[Bound]:
    """Return what is defined in the line that it breaks, and has another value then."""
    old, new = (dict(DEFINITION.findall(text)) for text in (mutant.old, mutant.new))
    return {Bound(mutant.file, name) for name in old if new.get(name, old[name]) != old[name]}


@pytest.fixture(scope="module")
def bounds() -> set[Bound]:
    paths = sorted((ROOT / "gateway").rglob("*.py"))
    files = ((path.relative_to(ROOT).as_posix(), path.read_text()) for path in paths)
    return {bound for file in files for bound in bounds_of(*file)}


@pytest.fixture(scope="module")
def named() -> set[Bound]:
    """All that a mutant names, whatever it is."""
    return {bound for mutant in load() for bound in named_by_mutant(mutant)}


@pytest.fixture(scope="module")
def changed() -> set[Bound]:
    """All that a mutant gives another value, whatever it is, and does not survive."""
    killed = (mutant for mutant in load() if mutant.survives is None)
    return {bound for mutant in killed for bound in changed_by_mutant(mutant)}


def test_every_bound_is_changed_by_a_mutant(bounds: set[Bound], changed: set[Bound]):
    missing = sorted(bounds - changed - NO_BOUNDS.keys())
    advice = "write a test that fails where each is another, and an entry in tools/mutants/"
    assert not missing, "\n".join([advice, *map(str, missing)])


def test_each_exception_exists_and_no_mutant_names_it(bounds: set[Bound], named: set[Bound]):
    assert NO_BOUNDS.keys() <= bounds, "gone, or with another name: take it out of the list"
    assert not NO_BOUNDS.keys() & named


@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("MAX_CLIENTS: Final = 64", ["MAX_CLIENTS"]),
        ("_LEAST_FREE: Final[float] = 0.5", ["_LEAST_FREE"]),
        ("PER_S: Final = 20.0", ["PER_S"]),
        ("SEND_BYTES: Final = 16 * 1024", ["SEND_BYTES"]),
        ("REST_NS: Final = -1", ["REST_NS"]),
        ("DUE_NS: Final = round(0.1 * SECOND)", ["DUE_NS"]),
        ("LARGE_BYTES: Final = HANDED_OVER_BYTES", []),
        ("KEPT_BYTES: Final = b'none'", []),
        ("PINGS: Final = 3", []),
        ("S: Final = 3", []),
        ("MAX_CLIENTS = 64", []),
    ],
)
def test_a_bound_is_known_by_its_name(line: str, names: list[str]):
    assert [bound.name for bound in bounds_of("x.py", line)] == names


LIMIT: Final = Bound("gateway/x.py", "LIMIT_S")


@pytest.mark.parametrize(
    ("old", "new", "is_changed"),
    [
        ("LIMIT_S: Final = 3", "LIMIT_S: Final = 30", True),
        ("LIMIT_S: Final[float] = 3", "LIMIT_S: Final[float] = 30", True),
        ("PINGS: Final = 3\nLIMIT_S: Final = 3", "PINGS: Final = 3\nLIMIT_S: Final = 30", True),
        ("PINGS: Final = 3\nLIMIT_S: Final = 3", "PINGS: Final = 30\nLIMIT_S: Final = 3", False),
        ("PINGS: Final = LIMIT_S", "PINGS: Final = 30", False),
        ("LIMIT_S: Final = 3", "pass", False),
        ("now_s > LIMIT_S:", "False:", False),
    ],
)
def test_a_mutant_names_what_its_line_has_and_changes_what_is_defined_there(old, new, is_changed):
    mutant = Mutant("gateway/x.py", "it ends", old, new, ("tests/test_x.py",))
    assert LIMIT in named_by_mutant(mutant)
    assert (LIMIT in changed_by_mutant(mutant)) is is_changed
