# SPDX-License-Identifier: Apache-2.0
"""Generated files in a user's folder, where other files must not be harmed."""

from collections.abc import Collection, Mapping
from fnmatch import fnmatch
from pathlib import Path
from typing import Final

from gateway.errors import GatewayError, UsageError, system_reason

_HEAD_BYTES: Final = 512  # the mark is in the first lines


def write_files(
    folder: Path,
    texts: Mapping[str, str],
    mark: str,
    *,
    replace: bool = False,
    optional: Collection[str] = (),
) -> list[Path]:
    """Write texts by their paths below a folder, and return the paths of the files that changed.

    A file without *mark* in its first lines is foreign. If there is one, nothing is written, unless
    *replace* is set. A foreign file whose name fits one of the patterns *optional* stays as it is.

    Raises:
        UsageError: files would be overwritten, or something else is in their place.
        GatewayError: a file cannot be read or written.
    """
    wanted = {folder / path: text.encode() for path, text in texts.items()}
    try:
        foreign = [path for path in wanted if _is_foreign(path, mark) and not replace]
        kept = {p for p in foreign if any(fnmatch(p.name, pattern) for pattern in optional)}
        if refused := [path for path in foreign if path not in kept]:
            more = f" and {len(refused) - 1} more" if len(refused) > 1 else ""
            raise UsageError(
                f"{refused[0]}{more} would be overwritten, and this command has not made it: "
                "choose another --output, or add --force"
            )
        changed = [
            path
            for path, content in wanted.items()
            if path not in kept and not (path.is_file() and path.read_bytes() == content)
        ]
        for path in changed:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(wanted[path])
    except OSError as error:
        raise GatewayError(f"cannot write {error.filename}, {system_reason(error)}") from error
    return changed


def made_files(folder: Path, pattern: str, mark: str) -> list[Path]:
    """Return the files of a folder that have *mark*, and none if the folder is missing.

    Raises:
        GatewayError: a file cannot be read.
    """
    try:
        return [p for p in sorted(folder.glob(pattern)) if p.is_file() and not _is_foreign(p, mark)]
    except OSError as error:
        raise GatewayError(f"cannot read {error.filename}, {system_reason(error)}") from error


def _is_foreign(path: Path, mark: str) -> bool:
    if not path.exists():
        return False
    if not path.is_file():  # a pipe would be waited for, a folder cannot be replaced either
        raise UsageError(f"{path} is not a file: choose another --output")
    with path.open("rb") as file:
        return mark.encode() not in file.read(_HEAD_BYTES)
