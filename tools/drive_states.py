# SPDX-License-Identifier: Apache-2.0
"""The tables of `gateway.drive` as Markdown, for docs/contributing/drive-states.md."""

from collections.abc import Iterable, Iterator
from textwrap import fill
from typing import Any, Final, get_args

from gateway.drive.decisions import DECISIONS, MOVES, STOPS
from gateway.drive.effects import GuardState
from gateway.drive.lease import LEASE
from gateway.drive.motion import MOTION
from gateway.drive.table import StateTable
from gateway.drive.trip_latch import LATCH
from gateway.drive.waiting import WAITING

_MACHINES: Final[tuple[StateTable[Any, Any, Any], ...]] = (MOTION, LATCH, WAITING, LEASE)


def drive_states() -> str:
    """Return the tables of the machines, and those that connect them."""
    return "\n".join((_moves(), _stops(), *map(_machine, _MACHINES)))


def _moves() -> str:
    guards = get_args(GuardState)
    rows = (
        (f"`{state}`", *(f"`{row[guard]}`" for guard in guards)) for state, row in MOVES.items()
    )
    heads = ("Trip latch", *(f"Guard `{guard}`" for guard in guards))
    decisions = _table(("Decision", "Then the command"), _terms(DECISIONS))
    return f"## A command to move\n\n{decisions}\n{_table(heads, rows)}"


def _stops() -> str:
    rows = (
        (f"`{reason}`", f"`{cause}`", f"`{event}`", f"`{trip}`" if trip else "")
        for reason, (cause, event, trip) in STOPS.items()
    )
    heads = ("Reason", "Cause that clients see", "Event of the motion", "Event of the latch")
    return f"## Stops\n\n{_table(heads, rows)}"


def _machine(machine: StateTable[Any, Any, Any]) -> str:
    heads = ("Event", *(f"`{state}`" for state in machine.states))
    rows = (
        (f"`{event}`", *(_cell(machine, state, event) for state in machine.states))
        for event in machine.events
    )
    actions = {name: text for name, text in machine.actions.items() if name}
    parts = (
        _table(("State", "Meaning"), _terms(machine.states)),
        _table(("Event", "Meaning"), _terms(machine.events)),
        _table(("Action", "Meaning"), _terms(actions)),
        _table(heads, rows),
    )
    reasons = dict.fromkeys(machine.impossible.values())
    impossible = "".join(
        fill(f"- {reason}: {_places(machine, reason)}", 100, subsequent_indent="  ") + "\n"
        for reason in reasons
    )
    return "\n".join(
        (f"## {machine.title}\n", *parts, f"Impossible, with the reason:\n\n{impossible}")
    )


def _cell(machine: StateTable[Any, Any, Any], state: str, event: str) -> str:
    """Return the next state and the action, or a dash. A state that stays is not named."""
    if (state, event) in machine.impossible:
        return "impossible"
    after, action = machine.rows[state][event]
    words = [f"`{after}`"] if after != state else []
    return ": ".join([*words, *([action.replace("_", " ")] if action else [])]) or "-"


def _places(machine: StateTable[Any, Any, Any], reason: str) -> str:
    places = (cell for cell, why in machine.impossible.items() if why == reason)
    return ", ".join(f"`{event}` in `{state}`" for state, event in places)


def _terms(terms: Any) -> Iterator[tuple[str, str]]:
    return ((f"`{name}`", f"{text[0].upper()}{text[1:]}") for name, text in terms.items())


def _table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    heads = tuple(heads)
    lines = (heads, ("---",) * len(heads), *rows)
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
