# SPDX-License-Identifier: Apache-2.0
"""The files whose code is broken, by which rules, and the tests that must notice."""

import random
import tomllib
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Final

from tools.mutants.rules import EVERYWHERE, IN_SAFETY, Mutant, mutants_of

ROOT: Final = Path(__file__).parents[2]
WAIVERS: Final = Path(__file__).with_name("waivers.toml")
# A bug in `gateway_sim` harms nobody's robot, and other code is only used by tests.
ROOTS: Final = ("gateway", "schemas")
GENERATED: Final = "schemas/models/"

# Here a mistake moves a robot or does not stop it, so all rules apply.
SAFETY: Final = (
    "gateway/drive/", "gateway/guard/", "gateway/core/commands/",
    "gateway/sources/rclpy/publishers.py",
)  # fmt: skip

# Tests in other folders, by the beginning of a path. They run last.
ELSEWHERE: Final = {
    "gateway/access": ("tests/test_security.py", "tests/core/test_permission_checks.py"),
    "gateway/cli/": ("tests/cli/test_main.py",),
    "gateway/codec/": ("tests/codec", "tests/core/topics"),
    "gateway/config/": ("tests/cli/test_main.py", "tests/core/test_router.py"),
    "gateway/core/": ("tests/core/test_router.py", "tests/core/test_small_rules.py"),
    "gateway/core/outbox.py": ("tests/core/topics",),
    "gateway/core/queue.py": ("tests/core/test_outbox.py", "tests/core/topics"),
    "gateway/core/provided.py": ("tests/core/services", "tests/core/actions"),
    "gateway/core/topics/": ("tests/transport/test_connection.py",),
    "gateway/drive/": ("tests/core/commands",),
    "gateway/fronts/rosbridge/": ("tests/core", "tests/transport/test_connection.py"),
    "gateway/fronts/rosbridge/tf2_web_republisher/": ("tests/core/transforms",),
    "gateway/metrics/": ("tests/transport/test_scrapes.py",),
    "gateway/record_app.py": ("tests/e2e/test_record.py",),
    "gateway/sources/": ("tests/sources",),
    "gateway/sources/node_definitions.py": ("tests/core/test_learned_types.py",),
    "gateway/tf/": ("tests/core/transforms",),
    "schemas/": ("tests/schemas", "tests/codec", "tests/cli/test_generate.py"),
}  # fmt: skip


# A file that more files import than these is tested by what is next to it.
MAX_IMPORTERS: Final = 12


def all_mutants(root: Path = ROOT) -> Iterator[Mutant]:
    """Yield all mutants, in the order of files and lines."""
    for folder in ROOTS:
        for path in sorted((root / folder).rglob("*.py")):
            file = path.relative_to(root).as_posix()
            if not file.startswith(GENERATED):
                rules = EVERYWHERE | (IN_SAFETY if file.startswith(SAFETY) else {})
                yield from mutants_of(file, path.read_bytes(), rules)


def waivers(path: Path = WAIVERS) -> dict[str, str]:
    """Return the reason of each mutant that no test can notice, by its name."""
    return tomllib.loads(path.read_text())


def select(
    mutants: Sequence[Mutant], words: Sequence[str], rules: Sequence[str], size: int, seed: int
) -> list[Mutant]:
    """Return the mutants with one of *words* in the name, of *rules*, and a sample of these."""
    chosen = [
        mutant
        for mutant in mutants
        if (not words or any(word in mutant.name for word in words))
        and (not rules or mutant.rule in rules)
    ]
    return random.Random(seed).sample(chosen, size) if 0 < size < len(chosen) else chosen  # noqa: S311


def stages_of(file: str, root: Path = ROOT) -> list[list[str]]:
    """Return the tests of a file, the nearest first, in groups that run one after another.

    They are its mirror, which is `tests/x/test_y.py` for `gateway/x/y.py`, the mirrors of files
    that import it and tests that do, the tests of its folder, and tests in other folders.
    """
    mirror = _mirror(file)
    importers = [_mirror(each) for each in _importers(file, root, ROOTS)]
    importers += _importers(file, root, ("tests",))
    folder = mirror.parent
    while not any((root / folder).glob("test_*.py")):
        folder = folder.parent
    beside = [path.relative_to(root) for path in sorted((root / folder).glob("test_*.py"))]
    far = [test for begin, tests in ELSEWHERE.items() if file.startswith(begin) for test in tests]
    stages: list[list[str]] = []
    for tests in (
        [mirror],
        importers if len(importers) <= MAX_IMPORTERS else [],
        beside if folder != Path("tests") else [],
        far,
    ):
        known = {test for stage in stages for test in stage}
        names = dict.fromkeys(map(str, tests))
        stages.append([name for name in names if name not in known and (root / name).exists()])
    return [stage for stage in stages if stage]


def _mirror(file: str) -> Path:
    path = Path(file)
    parts = path.parts[1:-1] if path.parts[0] == "gateway" else path.parts[:-1]
    return Path("tests", *parts, f"test_{path.name}")


def _importers(file: str, root: Path, folders: Sequence[str]) -> list[str]:
    module = ".".join(Path(file).with_suffix("").parts)
    pattern = f"from {module} import "
    texts = (each for folder in folders for each in _texts(root / folder).items())
    names = [path.relative_to(root).as_posix() for path, text in texts if pattern in text]
    return [name for name in names if folders == ROOTS or Path(name).name.startswith("test_")]


@cache
def _texts(folder: Path) -> dict[Path, str]:
    return {path: path.read_text() for path in sorted(folder.rglob("*.py"))}
