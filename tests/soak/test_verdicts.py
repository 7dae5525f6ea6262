# SPDX-License-Identifier: Apache-2.0
"""Each thing that must hold fails where it does not, and a late machine fails nothing."""

from dataclasses import replace

import pytest

from tests.soak.accounting import Accounting
from tests.soak.driving import Fault
from tests.soak.load import CAMERA, NUMBERS, TOPICS
from tests.soak.machine import Machine
from tests.soak.record import BAD_LINK, FROZEN, GOOD, Exit, Record
from tests.soak.verdicts import judge
from tests.soak.vitals import Leftovers, Vitals

SECONDS = 1200
REST = Leftovers(26, 22, 3, 0, 0, 34)


def listener(**changes):
    sequence = {"received": 1000, "epochs": 1, "missing": 0, "repeated": 0, "disordered": 0}
    return {
        "heard": {topic.name: 1000 for topic in TOPICS},
        "gaps": {topic.name: [] for topic in TOPICS},
        "sequence": sequence,
        "drops": {topic.name: {"missing": 5, "counted": 5, "uncounted": 0} for topic in TOPICS},
        "connections": 1,
        "ends": [],
        "round_trips": [(at / 10, 0.002, 0.001) for at in range(SECONDS * 10)],
        **changes,
    }


def vitals(own_mb):
    return [
        Vitals(float(at), own_mb(at) + 90, own_mb(at), 26, 22, 0.0) for at in range(0, SECONDS, 10)
    ]


def record(**changes) -> Record:
    accounting = Accounting()
    accounting.sums = accounting.pages = 1
    fault = Fault("client frozen", 100.0, 0.55, 0.6)
    good = Record(
        minutes=SECONDS / 60,
        begin_s=0.0,
        end_s=float(SECONDS),
        link="a link",
        baseline=REST,
        final=REST,
        vitals=vitals(lambda at: 80.0 + at % 30),
        machine=Machine(),
        accounting=accounting,
        clients={name: listener() for name in (*GOOD, BAD_LINK, FROZEN)},
        bare=listener(),
        away=[(60.0, 68.0)],
        faults=[fault],
        exit=Exit(0, 0.3, 0.0, 1210.0, 0.01, (), 0),
    )
    return replace(good, **changes)


def client(name, **changes):
    clients = {each: listener() for each in (*GOOD, BAD_LINK, FROZEN)}
    return {**clients, name: listener(**changes)}


def heard(topic, count):
    return {"heard": {**listener()["heard"], topic.name: count}}


def sequence(**changes):
    return {"sequence": {**listener()["sequence"], **changes}}


def failing(found: Record, *, strict: bool = True) -> list[str]:
    return [one.subject for one in judge(found, strict=strict) if one.failed]


def unequal() -> Accounting:
    accounting = Accounting()
    accounting.sums = 2
    accounting.faults.append("received 2, but sent 1")
    return accounting


@pytest.mark.parametrize("strict", [True, False])
def test_all_holds_where_nothing_is_wrong(strict):
    assert failing(record(), strict=strict) == []


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize(
    ("changes", "subject"),
    [
        ({"vitals": vitals(lambda at: 80 + at / 60)}, "memory grows by"),
        ({"final": replace(REST, descriptors=27)}, "descriptors at the end"),
        ({"final": replace(REST, threads=23)}, "threads at the end"),
        ({"final": replace(REST, tasks=4)}, "tasks at the end"),
        ({"final": replace(REST, ros_entities=1)}, "ros entities at the end"),
        ({"final": replace(REST, other_opened=1)}, "other opened at the end"),
        ({"final": replace(REST, shared_memory_files=35)}, "shared memory files at the end"),
        ({"clients": client(GOOD[0], **sequence(missing=1))}, "numbers at good 1"),
        ({"clients": client(GOOD[1], **sequence(repeated=1))}, "numbers at good 2"),
        ({"clients": client(GOOD[1], **sequence(disordered=1))}, "numbers at good 2"),
        ({"clients": client(GOOD[0], connections=2)}, "connections of good 1"),
        (
            {"clients": client(BAD_LINK, **heard(NUMBERS, 249))},
            f"messages to the client {BAD_LINK}",
        ),
        (
            {"clients": client(FROZEN, **heard(CAMERA, 9))},
            f"messages to the client {FROZEN}",
        ),
        ({"accounting": unequal()}, "received = sent + coalesced + dropped + pending"),
        ({"accounting": Accounting()}, "received = sent + coalesced + dropped + pending"),
        ({"clients": client(GOOD[0], gaps={CAMERA.name: [(50.0, 51.5)]})}, "longest silence"),
        ({"clients": client(GOOD[0], gaps={CAMERA.name: [(60.0, 69.5)]})}, "longest silence"),
        (
            {"faults": [Fault("link black", 100.0, 9.0, 0.6)]},
            "robot stops, link black",
        ),
        (
            {"faults": [Fault("link black", 100.0, 0.5, 0.6, moved_again=True)]},
            "robot stops, link black",
        ),
        ({"faults": []}, "faults injected"),
        ({"exit": Exit(0, 4.0, 0.0, 1210.0, 0.01, (), 0)}, "exit by SIGTERM"),
        ({"exit": Exit(1, 0.3, 0.0, 1210.0, 0.01, (), 0)}, "exit code"),
        ({"exit": Exit(0, 0.3, 0.0, 1210.0, 3.0, (), 0)}, "robot stops, SIGTERM"),
        ({"exit": Exit(0, 0.3, 0.0, 1210.0, 0.01, ("a",), 0)}, "files left in /dev/shm"),
        ({"exit": Exit(0, 0.3, 0.0, 1210.0, 0.01, (), 1)}, "tracebacks in the log"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_fault_is_found(changes, subject, strict):
    assert failing(record(**changes), strict=strict) == [subject]


@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize(
    ("missing", "counted", "uncounted"), [(5, 4, 1), (5, 205, 0)], ids=["too few", "too many"]
)
def test_drops_that_are_counted_wrongly_are_found(strict, missing, counted, uncounted):
    wrong = {"missing": missing, "counted": counted, "uncounted": uncounted}
    found = record(clients=client(FROZEN, drops={CAMERA.name: wrong}))
    assert failing(found, strict=strict) == [f"samples lost by the client {FROZEN}"]


@pytest.mark.parametrize(
    ("strict", "late_s"), [(True, 0.02), (False, 0.2)], ids=["strict", "lenient"]
)
def test_round_trips_that_get_slower_are_found(strict, late_s):
    trips = [(at / 10, late_s if at > SECONDS * 7 else 0.002, 0.001) for at in range(SECONDS * 10)]
    clients = {name: listener(round_trips=trips) for name in (*GOOD, BAD_LINK, FROZEN)}
    assert failing(record(clients=clients), strict=strict) == ["p99 of round trips, first to last"]


def test_a_load_that_loses_nothing_is_too_small():
    none = {"missing": 0, "counted": 0, "uncounted": 0}
    clients = {
        **client(BAD_LINK, drops={CAMERA.name: none}),
        FROZEN: listener(drops={CAMERA.name: none}),
    }
    assert failing(record(clients=clients)) == ["samples lost at all"]


def late(at_s: float, by_s: float) -> Machine:
    return Machine(late=[(at_s, by_s)])


@pytest.mark.parametrize(
    ("changes", "subject"),
    [
        (
            {"faults": [Fault("link black", 99.9, 0.7, 0.6)], "machine": late(100.3, 0.2)},
            "robot stops, link black",
        ),
        (
            {
                "clients": client(GOOD[0], gaps={CAMERA.name: [(99.0, 101.5)]}),
                "machine": late(101.4, 2.0),
            },
            "longest silence",
        ),
        ({"exit": Exit(0, 4.0, 3.0, 1210.0, 0.01, (), 0)}, "exit by SIGTERM"),
        ({"vitals": vitals(lambda at: 80.0 + (30 if at > 600 else 0))}, "memory grows by"),
    ],
    ids=["fault", "silence", "exit", "a step"],
)
def test_a_late_machine_is_allowed_for_leniently(changes, subject):
    assert failing(record(**changes)) == [subject]
    assert failing(record(**changes), strict=False) == []


def test_round_trips_may_get_slower_as_an_echo_does_leniently():
    slow = [
        (at / 10, *((0.02, 0.01) if at > SECONDS * 7 else (0.002, 0.001))) for at in range(12000)
    ]
    clients = {name: listener(round_trips=slow) for name in (*GOOD, BAD_LINK, FROZEN)}
    assert failing(record(clients=clients)) == ["p99 of round trips, first to last"]
    assert failing(record(clients=clients), strict=False) == []


def test_numbers_that_the_bare_subscriber_also_misses_are_not_the_gateways():
    bare = listener(**sequence(missing=1))
    assert failing(record(bare=bare, clients=client(GOOD[0], **sequence(missing=1)))) == []


def test_a_short_soak_may_reserve_something_once():
    once = vitals(lambda at: 80.0 + (6 if at > 150 else 0))[:31]
    assert failing(record(vitals=once, end_s=300.0)) == []
    grows = vitals(lambda at: 80.0 + at / 5)[:31]
    assert failing(record(vitals=grows, end_s=300.0)) == ["memory grows by"]


def test_an_end_by_force_is_excused_leniently_by_the_wait_for_cores_alone():
    forced = Exit(1, 2.0, 1.5, 1210.0, 0.01, ("a",), 0, was_forced=True)
    assert failing(record(exit=forced), strict=False) == []
    wrong = ["exit code", "files left in /dev/shm"]
    assert failing(record(exit=forced)) == wrong
    assert failing(record(exit=replace(forced, waited_s=0.1)), strict=False) == wrong
