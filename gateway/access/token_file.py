# SPDX-License-Identifier: Apache-2.0
"""The file with the hashes of the tokens."""

import contextlib
import os
import stat
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from gateway.access.tokens import TokenFileError, Tokens, from_json, to_json
from gateway.errors import system_reason

MAX_FILE_BYTES = 1024**2  # a thousand tokens take 200 KB


def default_path(environment: Mapping[str, str]) -> Path:
    """Return the place of the file by the XDG Base Directory Specification."""
    base = environment.get("XDG_CONFIG_HOME", "")
    # the specification: a relative path is invalid, and ignored
    folder = Path(base) if base.startswith("/") else Path.home() / ".config"
    return folder / "ros2-gateway" / "tokens.json"


def read(path: Path) -> Tokens:
    """Read the tokens. A file that does not exist has none.

    Raises:
        TokenFileError: it is unreadable or not a token file, or others may write it.
    """
    try:
        with path.open("rb") as file:
            mode = os.fstat(file.fileno()).st_mode
            data = file.read(MAX_FILE_BYTES + 1)
    except FileNotFoundError:
        return Tokens()
    except OSError as error:
        raise TokenFileError(f"cannot read {path}, {system_reason(error)}") from error
    if sys.platform != "win32" and mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise TokenFileError(f"{path} can be changed by others: run chmod 600 {path}")
    if len(data) > MAX_FILE_BYTES:
        raise TokenFileError(f"{path} is not a token file: more than {MAX_FILE_BYTES} bytes")
    try:
        return from_json(data)
    except TokenFileError as error:
        raise TokenFileError(f"{path} is not a token file: {error}") from error


def change(path: Path, changed: Callable[[Tokens], Tokens]) -> None:
    """Replace the tokens by *changed* of them, in one step: readers see the old or the new file.

    Raises:
        TokenFileError: *changed* raises it, or the file cannot be read or written.
    """
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with _locked(path.parent):
            replace(path, to_json(changed(read(path))))
    except OSError as error:
        raise TokenFileError(f"cannot write {path}, {system_reason(error)}") from error


def replace(path: Path, data: bytes) -> None:
    """Write a file that its owner alone can read, in one step.

    Raises:
        OSError: it cannot be written. The old file stays.
    """
    new = path.with_name(f".{path.name}.new")
    new.unlink(missing_ok=True)  # of a process that died here: we hold the lock
    descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(descriptor)
        new.replace(path)
    except OSError:
        new.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    if sys.platform == "win32":  # which cannot lock a directory: the last writer wins
        yield
        return
    import fcntl

    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)  # and with it the lock
