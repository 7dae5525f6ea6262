# SPDX-License-Identifier: Apache-2.0
"""The thread that sends, and the calls that come back."""

import asyncio
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh import outgoing
from gateway.sources.zenoh.outgoing import Mailbox, Outgoing
from gateway.sources.zenoh.publishing import ZenohPublisher
from tests.client import eventually
from tests.sources.test_contract import INT32, number
from tests.sources.zenoh.conftest import OPTIONS, open_robot


@pytest.fixture
def thread() -> Iterator[Outgoing]:
    thread = Outgoing()
    yield thread
    thread.close()


async def test_while_the_thread_waits_only_urgent_messages_go_directly() -> None:
    with open_robot(replace(OPTIONS, reserved_topics=("/cmd_vel",))) as (source, _):
        released = threading.Event()

        def publish(topic: str) -> ZenohPublisher:
            publisher = source.publishing.advertise(topic, INT32, Qos(), lambda _: None)
            publisher.publish(number(1))
            return publisher

        assert publish("/count")._sending == 0
        source.publishing._outgoing.send("topic /map", 1, released.wait)
        held, urgent = publish("/goal"), publish("/cmd_vel")
        assert (held._sending, urgent._sending) == (1, 0)
        released.set()
        await eventually(lambda: held._sending == 0)


async def test_a_closing_is_taken_however_much_waits(thread, monkeypatch) -> None:
    monkeypatch.setattr(outgoing, "MAX_WAITING", 1)
    released, withdrawn = threading.Event(), threading.Event()
    thread.send("topic /map", 1, released.wait)
    with pytest.raises(RosError, match="no more is taken"):
        thread.send("topic /map", 1, released.wait)
    thread.finish(withdrawn.set)
    released.set()
    await eventually(withdrawn.is_set)


async def test_a_send_that_fails_ends_nothing(thread, caplog) -> None:
    def fail() -> None:
        raise ValueError("no such key")

    sent = threading.Event()
    thread.send("topic /map", 1, fail)
    thread.send("topic /map", 1, sent.set)
    await eventually(sent.is_set)
    await eventually(lambda: not thread.is_busy)
    assert "no such key" in caplog.text


async def test_the_error_of_a_call_is_heard_of_and_the_others_are_made() -> None:
    made: list[int] = []

    def fail() -> None:
        raise IndexError

    mailbox = Mailbox(asyncio.get_running_loop())
    calls: list[Callable[[], None]] = [fail, lambda: made.append(1)]
    for each in calls:
        mailbox.put(each)
    with pytest.raises(IndexError):
        mailbox.deliver()
    mailbox.deliver()
    assert made == [1]
    mailbox.close()
