# SPDX-License-Identifier: Apache-2.0
"""The results of a check: findings, which need an action, and notes, which do not."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

FindingLevel = Literal["error", "warning"]


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong (``error``), or that may be (``warning``).

    The advice begins with a verb.
    """

    level: FindingLevel
    what: str
    why: str
    advice: str


@dataclass(frozen=True, slots=True)
class Note:
    """Something that was checked and is in order, or that cannot be checked."""

    text: str


Result: TypeAlias = "Finding | Note"
Results: TypeAlias = Iterator[Result]
Check: TypeAlias = Callable[[], Results]
