# SPDX-License-Identifier: Apache-2.0
"""Each cell of the tables is written down, and a drive reaches each row and no impossible cell."""

import pickle
from collections import deque
from collections.abc import Callable, Hashable, Iterator
from dataclasses import replace
from itertools import product
from typing import Any, get_args

import pytest

from gateway.drive import decisions, lease, motion, trip_latch, waiting
from gateway.drive import drive as drive_module
from gateway.drive.burst import BACKLOG
from gateway.drive.drive import Drive
from gateway.drive.effects import Cause, Command, Effects, GuardState
from gateway.drive.freshness import Age
from gateway.drive.table import StateTable
from gateway.drive.velocity import ZERO, Velocity
from tests.drive.histories import RULES

MS = 1_000_000
START_NS = 10**12
AHEAD = Velocity(linear_x=0.2)
BARRED = replace(RULES, first_command="zero")
MACHINES: list[tuple[StateTable[Any, Any, Any], type, Any, Any, Any]] = [
    (
        motion.MOTION,
        motion.Motion,
        motion.MotionState,
        motion.MotionEvent,
        motion.MotionAction,
    ),
    (
        trip_latch.LATCH,
        trip_latch.TripLatch,
        trip_latch.LatchState,
        trip_latch.LatchEvent,
        trip_latch.LatchAction,
    ),
    (
        waiting.WAITING,
        waiting.WaitingCommand,
        waiting.WaitingState,
        waiting.WaitingEvent,
        waiting.WaitingAction,
    ),
    (lease.LEASE, lease.Lease, lease.LeaseState, lease.LeaseEvent, lease.LeaseAction),
]
# The calls that a drive is given in each of its states, after each of these times without a tick.
TIMES_MS = (0, 20, 250, 500, 2000)
Call = Callable[[Drive, int], Effects]


def command(client: Hashable, velocity: Velocity, age: Age = "unknown") -> Call:
    return lambda drive, now_ns: drive.command(Command(client, velocity, age), now_ns)


def burst(count: int) -> Call:
    def call(drive: Drive, now_ns: int) -> Effects:
        for _ in range(count):
            drive.command(Command("a", AHEAD), now_ns)
        return drive.end_turn(now_ns)

    return call


def of(name: str, argument: str) -> Call:
    return lambda drive, now_ns: getattr(drive, name)(argument, now_ns)


CALLS: list[Call] = [
    *(command(*each) for each in product("ab", (ZERO, AHEAD))),
    *(command("a", velocity, "fresh") for velocity in (ZERO, AHEAD)),
    command("a", ZERO, "stale"),
    burst(3),
    burst(BACKLOG + 1),
    Drive.end_turn,
    Drive.tick,
    *(of(name, "a") for name in ("invalid", "leave", "revoke", "release")),
    *(of(name, client) for name, client in product(("stop", "acquire"), "ab")),
    *(of("set_guard", guard) for guard in get_args(GuardState)),
    Drive.shut_down,
]


@pytest.mark.parametrize(("table", "machine", "states", "events", "actions"), MACHINES)
def test_each_cell_is_a_row_or_is_impossible(table, machine, states, events, actions):
    rows = {(state, event) for state, cells in table.rows.items() for event in cells}
    assert not rows & set(table.impossible)
    assert rows | set(table.impossible) == set(product(get_args(states), get_args(events)))
    targets = [cell for cells in table.rows.values() for cell in cells.values()]
    assert {state for state, _ in targets} <= set(get_args(states))
    assert {action for _, action in targets} - {""} == set(get_args(actions)) - {""}
    assert all(table.impossible.values())
    for texts, names in (
        (table.states, states),
        (table.events, events),
        (table.actions, actions),
    ):
        assert tuple(texts) == tuple(name for name in get_args(names) if name)
    assert machine().state == next(iter(table.states))


def test_each_stop_and_each_command_to_move_is_decided():
    causes = set(get_args(Cause)) - {"start"}  # it is not a stop
    assert {cause for cause, _, _ in decisions.STOPS.values()} == causes
    assert set(decisions.MOVES) == set(get_args(trip_latch.LatchState))
    assert all(set(row) == set(get_args(GuardState)) for row in decisions.MOVES.values())
    assert set(decisions.DECISIONS) == set(get_args(decisions.Decision))


class Noting(dict):
    """A row, or a table, that notes which of its cells are read."""

    def __init__(self, cells: Any, seen: set[Any], place: tuple[str, ...]) -> None:
        super().__init__(cells)
        self.seen, self.place = seen, place

    def __getitem__(self, key: str) -> Any:
        self.seen.add((*self.place, key))
        return super().__getitem__(key)


def noting(rows: Any, seen: set[Any], name: str) -> dict[str, Noting]:
    return {state: Noting(cells, seen, (name, state)) for state, cells in rows.items()}


def state_of(drive: Drive) -> tuple[Any, ...]:
    """Return the states of the machines, and the clients in them."""
    return (
        drive._rules,
        drive._motion.state,
        drive._motion.is_single,
        drive._latch.state,
        drive._waiting.state,
        drive._waiting.client,
        drive._lease.state,
        drive._lease.holder,
        drive._guard,
    )


def search(starts: list[Drive]) -> Iterator[None]:
    """Give each state that is found each call after each time, and go on from what comes of it."""
    found = set(map(state_of, starts))
    todo = deque((pickle.dumps(drive), START_NS) for drive in starts)
    while todo:
        blob, now_ns = todo.popleft()
        for wait_ms, call in product(TIMES_MS, CALLS):
            drive = pickle.loads(blob)  # noqa: S301  # made above
            then_ns = now_ns + wait_ms * MS
            call(drive, then_ns)
            if state_of(drive) not in found:
                found.add(state_of(drive))
                todo.append((pickle.dumps(drive), then_ns))
        yield


def test_a_drive_reaches_each_row_and_no_impossible_cell(monkeypatch):
    seen: set[tuple[str, ...]] = set()
    monkeypatch.setattr(drive_module, "STOPS", Noting(decisions.STOPS, seen, ("stops",)))
    rows = {
        "moves": (drive_module, "MOVES", decisions.MOVES),
        "motion": (motion, "_ROWS", motion.MOTION.rows),
        "latch": (trip_latch, "_ROWS", trip_latch.LATCH.rows),
        "waiting": (waiting, "_ROWS", waiting.WAITING.rows),
        "lease": (lease, "_ROWS", lease.LEASE.rows),
    }
    missing = {("stops", reason) for reason in decisions.STOPS}
    for name, (module, attribute, table) in rows.items():
        monkeypatch.setattr(module, attribute, noting(table, seen, name))
        missing |= {(name, state, event) for state, cells in table.items() for event in cells}

    starts = [Drive("/cmd_vel", rules, "ready") for rules in (RULES, BARRED)]
    aging = Drive("/cmd_vel", RULES, "ready")  # the search does not tell its two times apart
    for client, velocity, at_ms in (("a", AHEAD, 0), ("a", ZERO, 1000), ("b", AHEAD, 2000)):
        aging.command(Command(client, velocity), START_NS + at_ms * MS)
    for _ in search(starts):
        missing -= seen
        if not missing:
            return
    raise AssertionError(f"no history reaches {missing}")
