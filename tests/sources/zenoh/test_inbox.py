# SPDX-License-Identifier: Apache-2.0
import asyncio
import os
import threading
from collections.abc import AsyncIterator, Callable

import pytest

from gateway.sources.source import MAX_TAKES_PER_TURN
from gateway.sources.zenoh.inbox import MAX_WAITING_BYTES, Arrival, Arrivals, Inbox, LoopWaker
from tests.client import eventually


@pytest.fixture(params=["eventfd", "without"])
async def inbox(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> AsyncIterator[Inbox]:
    if request.param == "without":
        monkeypatch.delattr(os, "eventfd", raising=False)
    inbox = Inbox(asyncio.get_running_loop())
    yield inbox
    inbox.close()


class Taken:
    def __init__(self, depth: int = 1000) -> None:
        self.batches: list[list[bytes]] = []
        self.arrivals = Arrivals(depth, lambda new: self.batches.append([each.cdr for each in new]))

    @property
    def all(self) -> list[bytes]:
        return [each for batch in self.batches for each in batch]


def sample(cdr: bytes) -> Arrival:
    return Arrival(cdr, b"", 0, "")


def on_thread(put: Callable[[], None]) -> None:
    thread = threading.Thread(target=put)
    thread.start()
    thread.join()


async def test_samples_of_a_thread_reach_the_loop_in_order_and_in_parts(inbox):
    one, other = Taken(), Taken()
    sent = [str(index).encode() for index in range(100)]

    def put() -> None:
        for each in sent:
            inbox.put(one.arrivals, sample(each))
        inbox.put(other.arrivals, sample(b"x"))

    on_thread(put)
    await eventually(lambda: len(one.all) == 100)
    assert one.all == sent
    assert other.all == [b"x"]
    assert max(map(len, one.batches)) == MAX_TAKES_PER_TURN
    on_thread(put)
    await eventually(lambda: len(one.all) == 200)


async def test_the_newest_win_in_a_full_queue(inbox):
    taken = Taken(depth=3)
    on_thread(lambda: [inbox.put(taken.arrivals, sample(bytes([each]))) for each in range(9)])
    await eventually(lambda: bool(taken.all))
    assert taken.all == [b"\6", b"\7", b"\10"]


async def test_all_queues_together_hold_a_limited_number_of_bytes(inbox):
    assert MAX_WAITING_BYTES == 64 * 1024**2
    large, small = Taken(), Taken()
    quarter = bytes(MAX_WAITING_BYTES // 4)
    for _ in range(6):
        inbox.put(large.arrivals, sample(quarter))
    inbox.put(small.arrivals, sample(b"x"))  # there is no room, and it has no sample to make some
    assert inbox._waiting_bytes == MAX_WAITING_BYTES
    await eventually(lambda: len(large.all) == 4)
    assert inbox._waiting_bytes == 0
    assert small.all == []
    inbox.put(small.arrivals, sample(b"y"))
    await eventually(lambda: small.all == [b"y"])


async def test_one_sample_passes_however_large_it_is(inbox):
    taken = Taken()
    inbox.put(taken.arrivals, sample(bytes(MAX_WAITING_BYTES + 1)))
    await eventually(lambda: len(taken.all) == 1)


async def test_nothing_comes_after_close(inbox):
    closed, other = Taken(), Taken()
    inbox.put(closed.arrivals, sample(b"1"))
    closed.arrivals.close()
    inbox.put(closed.arrivals, sample(b"2"))
    inbox.put(other.arrivals, sample(b"3"))
    await eventually(lambda: bool(other.all))
    assert closed.all == []
    assert inbox._waiting_bytes == 0


@pytest.fixture
async def unhandled() -> list[str]:
    """Return the names of the errors that the loop has caught."""
    names: list[str] = []
    asyncio.get_running_loop().set_exception_handler(
        lambda _, context: names.append(type(context["exception"]).__name__)
    )
    return names


def fail(_: object) -> None:
    raise ZeroDivisionError


async def test_a_reader_that_fails_delays_none_of_the_others(inbox, unhandled):
    failing, taken = Arrivals(1, fail), Taken()
    inbox.put(failing, sample(b"1"))
    inbox.put(taken.arrivals, sample(b"2"))
    await eventually(lambda: taken.all == [b"2"])
    assert unhandled == ["ZeroDivisionError"]


async def test_a_flush_delivers_all_that_waits_for_a_reader(inbox):
    taken = Taken()
    for _ in range(3 * MAX_TAKES_PER_TURN + 1):
        inbox.put(taken.arrivals, sample(b"x"))
    inbox.flush(taken.arrivals)
    assert len(taken.all) == 3 * MAX_TAKES_PER_TURN + 1


async def test_a_thread_that_is_about_to_wake_writes_to_no_other_file(monkeypatch):
    """Close while another thread is between its test and its write."""
    if not hasattr(os, "eventfd"):
        pytest.skip("there is no eventfd")
    write, tested, closed = os.eventfd_write, threading.Event(), threading.Event()
    written: list[int] = []

    def write_late(fd: int, value: int) -> None:
        tested.set()
        closed.wait(0.2)  # the lock makes `close` wait for this, so it only ends by time
        write(fd, value)
        written.append(fd)

    monkeypatch.setattr(os, "eventfd_write", write_late)
    waker = LoopWaker(asyncio.get_running_loop(), lambda: None)
    thread = threading.Thread(target=waker.wake)
    thread.start()
    tested.wait()
    waker.close()
    closed.set()
    thread.join()
    assert len(written) == 1
    waker.wake()
    assert len(written) == 1
