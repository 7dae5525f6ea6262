# SPDX-License-Identifier: Apache-2.0
"""States x events as a table: for each cell the next state and an action.

A drive has four small machines, each in one file with its table: its motion, its trip latch, the
command that waits, and the lease. `gateway.drive.decisions` connects them. The same tables are in
docs/contributing/drive-states.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

S = TypeVar("S", bound=str)
E = TypeVar("E", bound=str)
A = TypeVar("A", bound=str)


@dataclass(frozen=True, slots=True)
class StateTable(Generic[S, E, A]):
    """One machine. The first state is the initial one, and the action "" does nothing.

    Each cell is either in *rows* or in *impossible*, with the reason.
    """

    title: str
    states: Mapping[S, str]
    events: Mapping[E, str]
    actions: Mapping[A, str]
    rows: Mapping[S, Mapping[E, tuple[S, A]]]
    impossible: Mapping[tuple[S, E], str]
