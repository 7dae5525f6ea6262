# SPDX-License-Identifier: Apache-2.0
"""The writers, one per language, and the comparison of their output with a tree."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from schemas.generate import (
    csharp_messages,
    interface_reference,
    json_schemas,
    python_models,
    reference,
)
from schemas.generate.catalogue import Catalogue


@dataclass(frozen=True, slots=True)
class Writer:
    """One language: its function, and the files of a tree that belong to it alone.

    ``write`` returns texts by path, relative to the root of the tree, with ``/``.
    ``owns`` is a glob: files that it matches and ``write`` does not return are stale.
    """

    write: Callable[[Catalogue], Mapping[str, str]]
    owns: str


WRITERS: Final = (
    Writer(python_models.write, "schemas/models/*.py"),
    Writer(json_schemas.write, "schemas/json/**/*.json"),
    Writer(csharp_messages.write, f"{csharp_messages.CSHARP_FOLDER}/*.cs"),
    Writer(reference.write, "docs/reference/messages.md"),
    Writer(interface_reference.write, "docs/reference/services.md"),
)


@dataclass(frozen=True, slots=True)
class Output:
    """The wanted content of a tree: texts by path, and the paths to remove."""

    texts: Mapping[Path, str]
    stale: tuple[Path, ...]

    @classmethod
    def of(cls, catalogue: Catalogue, root: Path) -> "Output":
        """Run the writers for the tree below *root*, without writing files."""
        texts: dict[Path, str] = {}
        owned: set[Path] = set()
        for writer in WRITERS:
            texts |= {root / path: text for path, text in writer.write(catalogue).items()}
            owned |= set(root.glob(writer.owns))
        return cls(texts, tuple(sorted(owned - texts.keys())))

    def differences(self) -> list[Path]:
        """List the files that are missing, different or stale, sorted."""
        differing = [
            path
            for path, text in self.texts.items()
            if not path.is_file() or path.read_bytes() != text.encode()
        ]
        return sorted([*differing, *self.stale])

    def write(self) -> list[Path]:
        """Bring the tree up to date. Return the changed paths."""
        changed = self.differences()
        for path in changed:
            if path in self.texts:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(self.texts[path].encode())
            else:
                path.unlink()
        return changed
