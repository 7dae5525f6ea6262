# SPDX-License-Identifier: Apache-2.0
"""Several clients say anything to a gateway with real ROS, over real sockets. See conversations.py.

`make fuzz WHAT=conversations` tries others each time, and for longer. It also measures what holds
the event loop. This does not, because on a busy machine others use the caches, and CPU time depends
on more than the code.
"""

import os
import time

import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis.errors import FlakyFailure
from hypothesis.stateful import run_state_machine_as_test

from tests.fuzz.conversations import Conversations, on
from tests.fuzz.stage import HoldError, Stage, open_stage

SECONDS = float(os.environ.get("FUZZ_SECONDS", "0"))
ALL = list(HealthCheck)
PLAIN = settings(database=None, deadline=None, suppress_health_check=ALL, phases=[Phase.generate])
SHORT = settings(PLAIN, max_examples=20, stateful_step_count=40, derandomize=True)
# until what is made once and stays is there: threads, the descriptors of the first subscriptions
WARM_UP = settings(PLAIN, max_examples=5, stateful_step_count=40, derandomize=True)
# A hold is not shortened: that takes minutes, and comes to chase what the machine does.
LONG = settings(PLAIN, max_examples=25, stateful_step_count=60)


def converse(stage: Stage, how: settings) -> None:
    run_state_machine_as_test(on(stage), settings=how)


def converse_again(stage: Stage) -> None:
    """Converse. An operation that holds the loop for too long fails if it does so again.

    Otherwise it is printed: others that share the machine's caches slow it down for a moment.
    """
    try:
        converse(stage, LONG)
    except FlakyFailure as error:
        _, others = error.split(HoldError)
        if others is not None:
            raise
        print("once, and not when it was said again:", *error.exceptions)


@pytest.mark.long
def test_every_operation_is_answered_and_leaves_nothing_behind():
    with open_stage() as stage:
        stage.start_threads()
        converse(stage, WARM_UP)
        stage.until_at_rest()
        converse(stage, SHORT)
        stage.until_at_rest()
        stage.check_log()


@pytest.mark.skipif(not SECONDS, reason="`make fuzz WHAT=conversations` runs it")
@pytest.mark.timeout(SECONDS + 600)
def test_nothing_that_clients_say_holds_the_event_loop():
    with open_stage(module="tests.fuzz.measured_gateway") as stage:
        stage.start_threads()
        converse(stage, SHORT)
        stage.until_at_rest()
        stage.begin_to_measure()
        end_s = time.monotonic() + SECONDS
        while time.monotonic() < end_s:
            converse_again(stage)
        stage.until_at_rest()
        stage.check_log()
    [longest] = [line for line in stage.gateway.log if line.startswith("longest")]
    print(f"{Conversations.exchanges} exchanges, {longest}")
