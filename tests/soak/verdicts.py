# SPDX-License-Identifier: Apache-2.0
"""The judgement of a soak: for each thing that must hold its figure, its bound, and a word.

Strictly, absolute bounds hold, which needs a quiet machine. Leniently (for a machine that is busy
with other tests), the bounds of times grow by the delays of the machine and more: only a fault of
another order fails.
"""

import itertools
import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from tests.soak.driving import Fault
from tests.soak.load import CAMERA, TOPICS
from tests.soak.record import BAD_LINK, FROZEN, GOOD, Record
from tests.soak.silences import beyond_control

HELD: Final = "held"
FAILED: Final = "FAILED"

GROWTH_MB_PER_MIN: Final = 0.5
_SLOPES: Final = 200  # times whose slopes are compared, each with each
LONG_MIN: Final = 15.0  # from here on the growth is judged by that bound
# A process may reserve so much once and late, which looks like growth in a short soak.
ONCE_MB: Final = 25.0  # the memory of two of the costliest frames while they are parsed
SILENCE_S: Final = 1.0
SLOWER: Final = 1.5  # the last quarter's round trips, by the first's
SLOWER_S: Final = 0.005
EXIT_S: Final = 2.0
ZERO_AT_EXIT_S: Final = 0.1
# A slow client gets at least these shares of a good client's messages. Its link is up for four
# fifths of the time, or it is awake for half of it. Small messages fit, and one image in ten.
SMALL_SHARE: Final = 0.25
PICTURE_SHARE: Final = 0.01
QUEUED: Final = (
    100  # samples that may be counted as dropped before the client sees that, per connection
)

# Leniently: a message passes some ten processes and threads, each of which may wait for a core.
LATENESS: Final = 10  # times what one sleep was late
BUSY_S: Final = 0.3  # and what no sleep noticed
WAITED_S: Final = 1.0  # as much at most of the time that threads waited: many wait at once


@dataclass(frozen=True)
class Verdict:
    """One judgement."""

    subject: str
    figure: str
    bound: str
    word: str

    @property
    def failed(self) -> bool:
        """True if something is wrong with the gateway."""
        return self.word == FAILED


def judge(record: Record, *, strict: bool) -> list[Verdict]:
    """Judge everything."""
    return [
        memory(record, strict=strict),
        *leftovers(record),
        *good_clients(record),
        *slow_clients(record),
        *drops(record),
        accounting(record),
        silence(record, strict=strict),
        round_trips(record, strict=strict),
        *faults(record, strict=strict),
        *the_end(record, strict=strict),
    ]


def memory(record: Record, *, strict: bool) -> Verdict:
    """Judge the growth of the gateway's own memory, by least squares.

    Leniently, also by the median of the slopes between any two times, which one step does not move.
    A gateway that gets no core for a while has more in its queues than before.
    """
    judged = [one for one in record.vitals if one.at_s >= record.warm_s]
    minutes = (judged[-1].at_s - judged[0].at_s) / 60
    points = [(one.at_s / 60, one.own_mb) for one in judged]
    slope = statistics.linear_regression(*zip(*points, strict=True)).slope
    few = points[:: max(1, len(points) // _SLOPES)]
    median = statistics.median(
        (after - before) / (later - earlier)
        for (earlier, before), (later, after) in itertools.combinations(few, 2)
    )
    bound = GROWTH_MB_PER_MIN if minutes >= LONG_MIN else GROWTH_MB_PER_MIN + ONCE_MB / minutes
    figure = f"{slope:+.2f} MB/min (median of slopes {median:+.2f}) over {minutes:.1f} min"
    figure += f", {judged[0].own_mb:.0f} -> {judged[-1].own_mb:.0f} MB"
    holds = slope < bound or (not strict and median < bound)
    return _verdict("memory grows by", figure, f"< {bound:.2g} MB/min", holds=holds)


def leftovers(record: Record) -> list[Verdict]:
    """Judge what is open once all clients have left."""
    beyond = record.final.beyond(record.baseline)
    return [
        _verdict(
            f"{name.replace('_', ' ')} at the end",
            f"{getattr(record.baseline, name)} -> {getattr(record.final, name)}",
            "as before",
            holds=name not in beyond,
        )
        for name in record.baseline.__dataclass_fields__
    ]


def good_clients(record: Record) -> list[Verdict]:
    """Judge the numbers that good clients got, and that they stayed connected."""
    verdicts = []
    for name in GOOD:
        report = record.clients[name]
        found = report["sequence"]
        faults = found["missing"] + found["repeated"] + found["disordered"]
        figure = (
            f"{found['missing']} missing, {found['repeated']} twice, {found['disordered']} out of"
            f" order, of {found['received']}"
        )
        # a number that the bare subscriber also misses was lost by DDS
        holds = not faults or record.bare["sequence"]["missing"] > 0
        verdicts.append(_verdict(f"numbers at {name}", figure, "none", holds=holds))
        ends = report["ends"]
        verdicts.append(
            _verdict(
                f"connections of {name}",
                f"{report['connections']}" + (f": {ends[0]}" if ends else ""),
                "1",
                holds=report["connections"] == 1 and not ends,
            )
        )
    return verdicts


def slow_clients(record: Record) -> list[Verdict]:
    """Judge that slow clients get what fits: one that gets nothing loses nothing uncounted."""
    all_heard = record.clients[GOOD[0]]["heard"]
    verdicts = []
    for name in (BAD_LINK, FROZEN):
        heard = record.clients[name]["heard"]
        shares = {one: heard[one.name] / max(all_heard[one.name], 1) for one in TOPICS}
        picture_share = shares.pop(CAMERA)
        small, small_share = min(shares.items(), key=lambda item: item[1])
        verdicts.append(
            _verdict(
                f"messages to the client {name}",
                f"{small_share:.0%} of {small.name}, {picture_share:.1%} of the pictures",
                f">= {SMALL_SHARE:.0%} and {PICTURE_SHARE:.0%}",
                holds=small_share >= SMALL_SHARE and picture_share >= PICTURE_SHARE,
            )
        )
    return verdicts


def drops(record: Record) -> list[Verdict]:
    """Judge, at slow clients, that samples they did not get are samples the gateway has counted."""
    verdicts = []
    for name in (BAD_LINK, FROZEN):
        report = record.clients[name]
        missing, counted, uncounted = (
            sum(one[part] for one in report["drops"].values())
            for part in ("missing", "counted", "uncounted")
        )
        allowed = QUEUED * report["connections"]
        verdicts.append(
            _verdict(
                f"samples lost by the client {name}",
                f"{missing} missing, {counted} counted as dropped, {uncounted} uncounted",
                f"0 uncounted, at most {allowed} not seen yet",
                holds=uncounted == 0 and 0 <= counted - missing <= allowed,
            )
        )
    lost = sum(
        one["missing"]
        for name in (BAD_LINK, FROZEN)
        for one in record.clients[name]["drops"].values()
    )
    # otherwise there was no load
    verdicts.append(_verdict("samples lost at all", f"{lost}", "> 0", holds=lost > 0))
    return verdicts


def accounting(record: Record) -> Verdict:
    """Judge the sums of /metrics."""
    found = record.accounting
    subject = "received = sent + coalesced + dropped + pending"
    figure = f"{found.sums} sums on {found.pages} pages, {len(found.faults)} wrong"
    if found.faults:
        figure += f": {found.faults[0]}"
    return _verdict(subject, figure, "some, 0 wrong", holds=bool(found.sums) and not found.faults)


def silence(record: Record, *, strict: bool) -> Verdict:
    """Judge the pauses of good clients, without those of publishers and of a bare subscriber."""
    worst_s, words, holds = 0.0, "none", True
    for name in GOOD:
        for topic, gaps in record.clients[name]["gaps"].items():
            for gap in gaps:
                extra_s = beyond_control(gap, [*record.bare["gaps"][topic], *record.away])
                late_s, waited_s = record.machine.worst_s(*gap), record.waited_s(*gap)
                if extra_s > worst_s:
                    worst_s, words = extra_s, f"{extra_s:.2f} s on {topic} at {name}"
                taken_s = 0 if strict else BUSY_S + LATENESS * late_s + waited_s
                holds &= extra_s <= SILENCE_S + taken_s
    return _verdict("longest silence", words, _bound(f"{SILENCE_S:g} s", strict), holds=holds)


def _bound(text: str, strict: bool) -> str:
    return text if strict else f"{text} and what the machine takes"


def round_trips(record: Record, *, strict: bool) -> Verdict:
    """Judge the round trips of the last quarter by those of the first."""
    trips = [trip for name in GOOD for trip in record.clients[name]["round_trips"]]
    quarter_s = (record.end_s - record.warm_s) / 4
    first = [one for one in trips if 0 <= one[0] - record.warm_s < quarter_s]
    last = [one for one in trips if 0 <= record.end_s - one[0] < quarter_s]
    before_s, after_s = _p99(first, 1), _p99(last, 1)
    echo_before_s, echo_after_s = _p99(first, 2), _p99(last, 2)
    allowed_s = SLOWER * before_s + SLOWER_S
    if not strict:  # a few hundred round trips next to other tests
        allowed_s = 3 * before_s * max(1.0, echo_after_s / echo_before_s) + 0.05
    figure = (
        f"{before_s * 1e3:.1f} -> {after_s * 1e3:.1f} ms"
        f" (an echo: {echo_before_s * 1e3:.1f} -> {echo_after_s * 1e3:.1f} ms)"
    )
    bound = f"{allowed_s * 1e3:.1f} ms"
    return _verdict("p99 of round trips, first to last", figure, bound, holds=after_s <= allowed_s)


def faults(record: Record, *, strict: bool) -> list[Verdict]:
    """Judge how soon each fault of the operator has stopped the robot."""
    verdicts = []
    for name in dict.fromkeys(fault.name for fault in record.faults):
        found = [fault for fault in record.faults if fault.name == name]
        is_late = any(one.took_s > _allowed(one, record, strict=strict) for one in found)
        moved = sum(one.moved_again for one in found)
        times = sorted(one.took_s for one in found)
        figure = f"median {times[len(times) // 2] * 1e3:.0f}, slowest {times[-1] * 1e3:.0f} ms"
        figure += f" of {len(times)}" + (f", {moved} moved again" if moved else "")
        bound = _bound(f"{found[0].bound_s * 1e3:.0f} ms", strict)
        holds = not (moved or is_late)
        verdicts.append(_verdict(f"robot stops, {name}", figure, bound, holds=holds))
    verdicts.append(
        _verdict("faults injected", f"{len(record.faults)}", "> 0", holds=bool(record.faults))
    )
    return verdicts


def the_end(record: Record, *, strict: bool) -> list[Verdict]:
    """Judge the end by SIGTERM."""
    end = record.exit
    late_s = record.machine.worst_s(end.at_s, end.at_s + max(end.took_s, end.zero_s))
    exit_s, zero_s = EXIT_S, ZERO_AT_EXIT_S
    if not strict:
        exit_s += BUSY_S + 2 * end.waited_s + LATENESS * late_s  # other threads also wait
        zero_s += BUSY_S + LATENESS * late_s
    # A gateway that gets no core ends itself by force, in time, and cannot clean up.
    is_excused = not strict and end.was_forced and end.waited_s > EXIT_S / 2
    took, zero = f"{end.took_s:.2f} s", f"{end.zero_s * 1e3:.0f} ms"
    left = ": ".join([f"{len(end.files_left)}", *filter(None, [", ".join(end.files_left)])])
    return [
        _verdict("exit by SIGTERM", took, f"{exit_s:.2g} s", holds=end.took_s <= exit_s),
        _verdict("exit code", f"{end.code}", "0", holds=end.code == 0 or is_excused),
        _verdict(
            "robot stops, SIGTERM", zero, f"{zero_s * 1e3:.0f} ms", holds=end.zero_s <= zero_s
        ),
        _verdict("files left in /dev/shm", left, "0", holds=not end.files_left or is_excused),
        _verdict("tracebacks in the log", f"{end.tracebacks}", "0", holds=not end.tracebacks),
    ]


def _allowed(fault: Fault, record: Record, *, strict: bool) -> float:
    if strict:
        return fault.bound_s
    time = fault.at_s, fault.at_s + fault.took_s
    waited_s = min(record.waited_s(*time), WAITED_S)
    return fault.bound_s + BUSY_S + LATENESS * record.machine.worst_s(*time) + waited_s


def _p99(trips: Sequence[Any], part: int) -> float:
    if len(trips) < 2:
        return math.inf
    return statistics.quantiles([float(one[part]) for one in trips], n=100)[98]


def _verdict(subject: str, figure: str, bound: str, *, holds: bool) -> Verdict:
    return Verdict(subject, figure, bound, HELD if holds else FAILED)
