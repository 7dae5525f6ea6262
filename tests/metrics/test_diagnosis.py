# SPDX-License-Identifier: Apache-2.0
from typing import Any

import pytest

from gateway.metrics.diagnosis import ERROR, OK, WARN, ComponentStatus, diagnose
from gateway.metrics.state import ControlState, Summary
from tests.metrics.states import DRIVE, client_state, summary


def of(component: str, now: Summary, before: Summary | None = None) -> ComponentStatus:
    (found,) = (each for each in diagnose(now, before) if each.component == component)
    return found


def test_all_is_well_with_a_gateway_that_has_little_to_do():
    assert {each.level for each in diagnose(summary(), summary())} == {OK}


@pytest.mark.parametrize(
    ("component", "changed", "level", "text"),
    [
        ("event loop", {"max_lag_s": 0.1}, WARN, "late by up to 100 ms"),
        ("event loop", {"max_lag_s": 0.5}, ERROR, "late by up to 500 ms"),
        ("clients", {"max_clients": 1}, WARN, "no room for another"),
        ("ROS entities", {"entities": {"ros_entities": 410}}, WARN, "410 of 512"),
        ("ROS entities", {"entities": {"ros_entities": 512}}, ERROR, "512 of 512"),
        ("ROS graph", {"shared_names": ("/a", "/b")}, WARN, "several nodes are named /a, /b"),
        ("ROS graph", {"shared_names": ("/a",) * 10}, WARN, "/a, /a and 2 more"),
        ("guard", {"control": ControlState((), False, 0)}, WARN, "starting"),
        ("guard", {"control": ControlState((), False, 2)}, ERROR, "lost"),
    ],
)
def test_each_problem_has_a_level_and_a_text(
    component: str, changed: dict[str, Any], level: int, text: str
):
    found = of(component, summary(**changed))
    assert found.level == level
    assert text in found.text


def test_a_safety_stop_has_its_reason_and_the_next_step():
    drive = DRIVE._replace(
        is_tripped=True, cause="commands stopped arriving", stops={"deadline": 3}
    )
    found = of("drive /cmd_vel", summary(control=ControlState((drive,), True, 0)))
    assert found.level == WARN
    assert found.text.startswith("stopped, commands stopped arriving: send a zero command")
    assert found.values["stops: deadline"] == 3


def test_only_clients_that_lose_messages_now_are_named():
    before = summary(
        clients=(
            client_state("a", dropped_by_full_queue=5),
            client_state("b", dropped_by_full_queue=5),
        )
    )
    now = summary(
        clients=(
            client_state("a", dropped_by_full_queue=5),
            client_state("b", dropped_by_full_queue=6),
            client_state("new", dropped_by_full_queue=1),
        )
    )
    found = of("delivery", now, before)
    assert (found.level, found.text) == (WARN, "too slow for what they subscribe to: b, new")
    assert (of("delivery", now, now).level, of("delivery", now, now).text) == (
        OK,
        "no queue overflows",
    )
    assert of("delivery", now).level == OK


def test_eight_clients_are_named_at_most():
    clients = tuple(client_state(f"c{number}", dropped_by_full_queue=1) for number in range(12))
    found = of("delivery", summary(clients=clients), summary())
    assert found.text.endswith("c6, c7 and 4 more")
