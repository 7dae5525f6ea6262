# SPDX-License-Identifier: Apache-2.0
"""The exception of a target: its fault, its shortest bytes, and a test of it."""

import hashlib
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.fuzz.target import FaultError

ROOT = Path(__file__).parents[2]
SHORTEN_S = 30.0
LONGEST_PRINTED = 1000  # bytes


def signature(error: BaseException) -> str:
    """Return the kind of a fault: equal for equal causes."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if frame.filename.startswith((str(ROOT), "<CDR"))]
    place = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else ""
    if isinstance(error, FaultError):  # raised by `check`: its caller says which
        caller = own[-2] if len(own) > 1 else own[-1]
        place = f"{Path(caller.filename).name}:{caller.lineno}"
    return f"{type(error).__name__} at {place}"


def fault_of(run: Callable[[bytes], None], data: bytes) -> str | None:
    """Return the signature of the fault that some bytes cause, if they cause one."""
    try:
        run(data)
    except Exception as error:
        return signature(error)
    return None


def shortest(run: Callable[[bytes], None], data: bytes) -> bytes:
    """Leave out what the fault does not need. A fault that does not come again stays whole."""
    wanted = fault_of(run, data)
    end_s = time.monotonic() + SHORTEN_S
    size = len(data) // 2
    while wanted and size:
        at = 0
        while at < len(data) and time.monotonic() < end_s:
            shorter = data[:at] + data[at + size :]
            if fault_of(run, shorter) == wanted:
                data = shorter
            else:
                at += size
        size //= 2
    return data


def as_test(name: str, data: bytes) -> str:
    """Return a test that fails until the fault is mended."""
    digest = hashlib.sha256(data).hexdigest()[:8]
    if len(data) > LONGEST_PRINTED:
        return f"# {len(data)} bytes, too many to print\n"
    return (
        f"def test_{name}_{digest}():\n"
        f"    # what is wrong, and why it may not be\n"
        f"    load({name!r}).run({data!r})\n"
    )


def text_of(run: Callable[[bytes], None], data: bytes) -> str:
    """Return the traceback of a fault."""
    with suppress(TypeError):
        try:
            run(data)
        except Exception:
            return traceback.format_exc(limit=-6)
    return "it did not come again\n"
