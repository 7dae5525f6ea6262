# SPDX-License-Identifier: Apache-2.0
"""A target: a function of bytes that raises if the product breaks a promise."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """A function to feed, and what to begin with.

    ``run`` is deterministic and leaves nothing behind: bytes that fail do so alone and again.
    """

    promise: str
    run: Callable[[bytes], None]
    seeds: Callable[[], Iterable[bytes]]


class FaultError(AssertionError):
    """The product has broken its promise."""


def check(holds: object, *what: object) -> None:
    """Raise `FaultError` unless something holds. `assert` would go with ``-O``."""
    if not holds:
        raise FaultError(*what)
