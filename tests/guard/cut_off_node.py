# SPDX-License-Identifier: Apache-2.0
"""A node of the guard process that is cut off as soon as something moves. It prints its zeros."""

import os
from typing import Any

from typing_extensions import Self


class CutOffNode:
    """Implements `gateway.sources.guard.GuardNode`, and its publisher."""

    is_acknowledged = True

    def __init__(self) -> None:
        self.is_cut_off = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def advertise(self, *_: Any) -> "CutOffNode":
        return self

    def readers(self, _: str) -> set[str]:
        return set()

    def moves(self, _: str) -> None:
        self.is_cut_off = True

    def publish(self, _: bytes) -> None:
        os.write(2, b"zero")

    def flush(self, _: float) -> None:
        pass
