# SPDX-License-Identifier: Apache-2.0
"""The types that the codecs are tried with: installed ones, and made-up ones."""

import random
import tempfile
from functools import cache
from pathlib import Path

from gateway.codec.types import MessageType, Types
from schemas.definition import PRIMITIVES
from schemas.installed import InstalledDefinitions, installed_prefixes
from tests.messages import RandomMessages

MADE_UP = 40


@cache
def types() -> Types:
    return Types(definitions())


@cache
def definitions() -> InstalledDefinitions:
    folder = Path(tempfile.mkdtemp(prefix="fuzz_types"))
    _make_up(folder / "share" / "odd_msgs" / "msg")
    found = InstalledDefinitions([*installed_prefixes(), folder])
    for name in found.names():
        found.closure([name])  # reads all files
    for path in sorted(folder.rglob("*"), reverse=True):
        path.unlink() if path.is_file() else path.rmdir()
    folder.rmdir()
    return found


def _make_up(share: Path) -> None:
    """Write definitions with fields of any kind, arrays of all kinds, nested."""
    share.mkdir(parents=True)
    chance = random.Random(0)
    names = ["Empty"]
    (share / "Empty.msg").write_text("")
    for number in range(MADE_UP):
        lines = []
        for field in range(chance.randint(1, 6)):
            base = chance.choice([*sorted(PRIMITIVES), *names, "string<=5", "float64", "uint8"])
            ending = chance.choice(["", "", "", "[]", "[2]", "[<=3]", "[30]"])
            lines.append(f"{base}{ending} f{field}\n")
        names.append(f"T{number}")
        (share / f"T{number}.msg").write_text("".join(lines))


@cache
def names() -> list[str]:
    return definitions().names()


def numbered(name: str) -> bytes:
    """Return the two bytes that choose a type."""
    return names().index(name).to_bytes(2, "little")


def chosen(data: bytes) -> MessageType:
    number = int.from_bytes(data[:2], "little")
    return types().get(names()[number % len(names())])


def example(name: str, seed: int = 1) -> dict[str, object]:
    return RandomMessages(definitions(), seed, longest=2).message(name)
