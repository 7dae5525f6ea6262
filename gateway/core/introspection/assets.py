# SPDX-License-Identifier: Apache-2.0
"""The models and pictures of installed packages, which a robot's description names.

A description (URDF, http://wiki.ros.org/urdf/XML/link) or a marker names them as
``package://arm/meshes/upper.stl``. This is the file below ``share/arm`` of the first prefix that
has the package. xacro's ``$(find arm)`` makes ``file://`` of it, which is the same file.
"""

import asyncio
import base64
import os
import re
import stat
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from urllib.parse import unquote

from gateway.backports import timeout
from gateway.codec.error_text import truncate
from gateway.core.errors import ProtocolError
from gateway.core.requests import FetchAsset
from schemas.installed import installed_prefixes

# The endings of meshes and textures. Other files of a package are not served.
SUFFIXES: Final = (".stl", ".dae", ".obj", ".mtl", ".glb", ".ply", ".png", ".jpg", ".jpeg")
MAX_BYTES: Final = 64 * 1024 * 1024
# An answer goes ahead of what waits in queues, so it is as small as a picture.
CHUNK_BYTES: Final = 32 * 1024

ANSWER_S: Final = 8.0  # less than a client waits, because a network disk may never answer

_PACKAGES: Final = "package://"
_PACKAGE: Final = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,254}")


@dataclass(frozen=True, slots=True)
class Chunk:
    """Some bytes of a file, from an offset that was asked for, and the size of the whole."""

    data: bytes
    size: int


class Assets:
    """Reads them in a thread, one chunk after the other: a disk may take its time."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="assets")

    def close(self) -> None:
        """Read no more. The thread ends with what it is reading."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def fetch(self, request: FetchAsset) -> dict[str, Any]:
        """Return the part of an asset that begins at an offset, for the answer.

        Raises:
            ProtocolError: as for `read`. ``timeout``: the disk, or others' assets, took too long.
        """
        loop = asyncio.get_running_loop()
        try:
            async with timeout(ANSWER_S):
                chunk = await loop.run_in_executor(
                    self._thread, read, request.uri, request.offset, installed_prefixes()
                )
        except TimeoutError:
            text = f"not read within {ANSWER_S:g} s, because the disk is slow: try again"
            raise ProtocolError("timeout", f"{_quoted(request.uri)}: {text}") from None
        return {
            "uri": request.uri,
            "offset": request.offset,
            "size": chunk.size,
            "data": base64.b64encode(chunk.data).decode(),
        }


def read(uri: str, offset: int, prefixes: Sequence[Path]) -> Chunk:
    """Read up to `CHUNK_BYTES` of an asset, none at its end.

    Raises:
        ProtocolError: ``bad_name``: the URI names no model or picture of a package.
            ``not_found``: the package or the file is missing. ``invalid_value``: *offset* is
            beyond its end. ``limit_exceeded``: it is too large.
    """
    path = _path(uri, prefixes)
    try:
        # not blocking, because it may be a FIFO
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:  # a ValueError of NUL
        reason = "the package has no such file, or it cannot be read"
        raise ProtocolError("not_found", f"{_quoted(uri)}: {reason}") from error
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise ProtocolError("not_found", f"{_quoted(uri)}: this is not a regular file")
        if status.st_size > MAX_BYTES:
            reason = f"it has {status.st_size} bytes, at most {MAX_BYTES} are allowed"
            raise ProtocolError("limit_exceeded", f"{_quoted(uri)}: {reason}")
        if offset > status.st_size:
            reason = f"offset: expected at most {status.st_size}, its size, got {offset}"
            raise ProtocolError("invalid_value", f"{_quoted(uri)}: {reason}")
        return Chunk(os.pread(descriptor, CHUNK_BYTES, offset), status.st_size)
    finally:
        os.close(descriptor)


def _path(uri: str, prefixes: Sequence[Path]) -> Path:
    """Return where an asset would be."""
    if uri.startswith(_PACKAGES):
        package, path = _checked(uri, unquote(uri.removeprefix(_PACKAGES)))
    else:
        prefixes, rest = _found(uri, prefixes)
        package, path = _checked(uri, rest)
    for prefix in prefixes:
        # not every folder there is a package: /usr/share has others
        if os.path.isfile(prefix / "share" / package / "package.xml"):  # noqa: PTH113  # raises nothing
            return prefix / "share" / package / path
    reason = f"the gateway's machine has no package {package}"
    raise ProtocolError("not_found", f"{_quoted(uri)}: {reason}, or its AMENT_PREFIX_PATH lacks it")


def _found(uri: str, prefixes: Sequence[Path]) -> tuple[Sequence[Path], str]:
    """Return the prefix of a ``file://`` and the path below its ``share``, if it is known."""
    for location in (uri, unquote(uri)):  # xacro writes paths as they are
        for prefix in prefixes:
            begin = f"file://{prefix}/share/"
            if location.startswith(begin):
                return (prefix,), location.removeprefix(begin)
    return (), ""


def _checked(uri: str, location: str) -> tuple[str, str]:
    """Return the name of the package and the path in it."""
    package, _, path = location.partition("/")
    if not _PACKAGE.fullmatch(package) or not path:
        expected = "expected package://PACKAGE/PATH, or file:// of the same file"
        raise ProtocolError("bad_name", f"{_quoted(uri)}: {expected}")
    if any(part in {"", ".", ".."} for part in path.split("/")):
        raise ProtocolError("bad_name", f"{_quoted(uri)}: . and .. are not allowed in the path")
    if not path.lower().endswith(SUFFIXES):
        expected = f"expected one of the files that end in {', '.join(SUFFIXES)}"
        raise ProtocolError("bad_name", f"{_quoted(uri)}: {expected}")
    return package, path


def _quoted(uri: str) -> str:
    return f"uri {truncate(uri)}"
