# SPDX-License-Identifier: Apache-2.0
from dataclasses import dataclass, field

from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.chunks import Chunks
from gateway.core.entries import NOT_READY, NOTHING, Frame
from gateway.core.outbox import Outbox
from gateway.core.queue import Queue


@dataclass
class Item:
    """An entry whose readiness the test decides."""

    text: bytes
    ready: bool = True
    encoded: int = field(default=0, compare=False)

    is_being_encoded: bool = False
    arrived_ns: int = 0

    @property
    def size(self) -> int:
        return len(self.text)

    def frame(self) -> Frame:
        self.encoded += 1
        return (self.text or NOTHING) if self.ready else NOT_READY


EVERYTHING = 1 << 30


def opened(depth: int, max_bytes: int = 1000) -> tuple[Outbox, Queue]:
    outbox = Outbox(max_bytes)
    return outbox, outbox.open_queue(depth, None)


def fill(queue: Queue, *texts: bytes) -> None:
    for text in texts:
        queue.put(Item(text))


def test_a_frame_in_pieces_is_taken_as_these_and_counts_as_one():
    outbox, queue = opened(10)
    pieces = Chunks.of([b"header", b"one", memoryview(b"two")])
    for frame in (pieces, b"small"):
        item = Item(b"size")
        item.frame = lambda frame=frame: frame  # type: ignore[method-assign, misc]
        queue.put(item)
    assert outbox.take(len(pieces)) == list(pieces.parts)
    assert (queue.sent, queue.sent_bytes) == (1, len(pieces))
    assert outbox.take(EVERYTHING) == [b"small"]


def test_control_frames_overtake_what_waits_in_queues():
    outbox = Outbox(1000)
    outbox.open_queue(10, None).put(Item(b"sample"))
    outbox.put_control(b"status")
    assert outbox.take(EVERYTHING) == [b"status", b"sample"]


def test_a_full_queue_drops_its_oldest_entry_and_counts_it():
    outbox, queue = opened(2)
    fill(queue, b"1", b"2", b"3")
    assert outbox.take(EVERYTHING) == [b"2", b"3"]
    assert queue.dropped == outbox.dropped == 1


def test_dropped_entries_were_never_encoded():
    queue = Outbox(1000).open_queue(1, None)
    old = Item(b"old")
    queue.put(old)
    queue.put(Item(b"new"))
    assert old.encoded == 0


def test_a_queue_holds_at_most_its_bytes_but_always_one_entry():
    outbox = Outbox(10_000)
    queue = outbox.open_queue(100, 10)
    for size in (6, 6, 500):
        queue.put(Item(bytes(size)))
    assert [len(frame) for frame in outbox.take(EVERYTHING)] == [500]
    assert queue.dropped == 2


def test_queues_take_turns():
    outbox = Outbox(1000)
    one, two = outbox.open_queue(10, None), outbox.open_queue(10, None)
    for queue, texts in ((one, (b"a1", b"a2")), (two, (b"b1", b"b2"))):
        for text in texts:
            queue.put(Item(text))
    assert outbox.take(EVERYTHING) == [b"a1", b"b1", b"a2", b"b2"]


def test_over_the_budget_the_heaviest_queue_loses_its_oldest():
    outbox = Outbox(100)
    camera, odometry = outbox.open_queue(100, None), outbox.open_queue(100, None)
    odometry.put(Item(b"odometry"))
    for _ in range(3):
        camera.put(Item(bytes(45)))
    assert camera.dropped == 1
    assert odometry.dropped == 0
    assert outbox.size <= 100


def test_one_entry_over_the_budget_is_sent_if_it_is_alone():
    outbox = Outbox(100)
    outbox.open_queue(10, None).put(Item(bytes(500)))
    assert [len(frame) for frame in outbox.take(EVERYTHING)] == [500]


def test_take_stops_after_its_bytes():
    outbox, queue = opened(10)
    for _ in range(3):
        queue.put(Item(bytes(10)))
    assert len(outbox.take(11)) == 2
    assert len(outbox.take(11)) == 1


def test_an_entry_that_is_not_ready_waits_without_holding_up_other_queues():
    outbox = Outbox(1000)
    picture = Item(b"picture", ready=False, is_being_encoded=True)
    pictures, odometry = outbox.open_queue(1, None), outbox.open_queue(1, None)
    pictures.put(picture)
    odometry.put(Item(b"odometry"))
    assert outbox.take(EVERYTHING) == [b"odometry"]
    newer = Item(b"newer")
    pictures.put(newer)  # must not replace the one whose turn has come
    assert outbox.take(EVERYTHING) == []
    picture.ready = True
    assert outbox.take(EVERYTHING) == [b"picture", b"newer"]


def test_an_entry_that_cannot_be_encoded_is_counted_and_holds_up_nothing():
    outbox, queue = opened(10)
    fill(queue, b"", b"next")
    assert outbox.take(EVERYTHING) == [b"next"]
    assert (queue.discarded, queue.sent) == (1, 1)


def test_an_entry_that_nobody_encodes_yet_gives_way_to_a_newer_one():
    outbox, queue = opened(1)
    declined = Item(b"old", ready=False)
    queue.put(declined)
    assert outbox.take(EVERYTHING) == []
    queue.put(Item(b"new"))
    declined.ready = True
    assert outbox.take(EVERYTHING) == [b"new"]
    assert queue.dropped == 1


def test_control_frames_beyond_the_budget_are_reported_not_dropped():
    outbox = Outbox(10)
    for _ in range(2):
        outbox.put_control(bytes(6))
        assert not outbox.overflowed
    outbox.put_control(bytes(6))
    assert outbox.overflowed
    assert len(outbox.take(EVERYTHING)) == 3
    assert not outbox.overflowed


def test_one_control_frame_may_be_as_large_as_it_is():
    outbox = Outbox(10)
    outbox.put_control(bytes(500))
    outbox.put_control(bytes(10))
    assert not outbox.overflowed
    assert (outbox.size, outbox.excess) == (510, 10)
    outbox.put_control(bytes(1))
    assert outbox.overflowed


def test_a_control_frame_beyond_the_budget_leaves_room_for_one_sample():
    outbox, queue = opened(10, 10)
    outbox.put_control(bytes(500))
    fill(queue, b"old", b"new")
    assert outbox.take(EVERYTHING)[1:] == [b"new"]


def test_closing_a_queue_forgets_what_waits_and_keeps_its_counts():
    outbox, queue = opened(1)
    queue.put(Item(b"1"))
    queue.put(Item(b"2"))
    outbox.close_queue(queue)
    assert outbox.take(EVERYTHING) == []
    assert (outbox.size, outbox.dropped) == (0, 1)


class Socket:
    """A socket that entries are passed to. It takes none while it is busy."""

    def __init__(self, outbox: Outbox) -> None:
        self.written: list[bytes] = []
        self.is_busy = False
        outbox.write_directly = self._write_directly

    def _write_directly(self, entry: Item) -> int:
        frame = NOT_READY if self.is_busy else entry.frame()
        if isinstance(frame, bytes):
            self.written.append(frame)
            return len(frame)
        return 0


def test_an_entry_that_comes_while_nothing_waits_goes_at_once_and_counts_as_sent():
    outbox = Outbox(1000)
    socket = Socket(outbox)
    queue = outbox.open_queue(10, None)
    queue.put(Item(b"1"))
    assert (socket.written, outbox.size, queue.sent) == ([b"1"], 0, 1)


def test_nothing_is_written_directly_past_what_waits():
    outbox = Outbox(1000)
    socket = Socket(outbox)
    queue, other = outbox.open_queue(10, None), outbox.open_queue(10, None)
    socket.is_busy = True
    queue.put(Item(b"1"))
    socket.is_busy = False
    queue.put(Item(b"2"))
    other.put(Item(b"3"))
    assert (socket.written, outbox.take(EVERYTHING)) == ([], [b"1", b"3", b"2"])
    queue.put(Item(b"4"))
    assert socket.written == [b"4"]


def test_an_entry_that_is_not_ready_keeps_only_its_own_queue_waiting():
    outbox = Outbox(1000)
    socket = Socket(outbox)
    queue, other = outbox.open_queue(10, None), outbox.open_queue(10, None)
    picture = Item(b"1", ready=False)
    queue.put(picture)
    assert outbox.take(EVERYTHING) == []
    other.put(Item(b"2"))
    queue.put(Item(b"3"))
    picture.ready = True
    assert (socket.written, outbox.take(EVERYTHING)) == ([b"2"], [b"1", b"3"])
    other.put(Item(b"4"))
    assert socket.written == [b"2", b"4"]


def test_nothing_is_written_directly_past_what_a_take_has_left():
    outbox = Outbox(1000)
    socket = Socket(outbox)
    queue, other = outbox.open_queue(10, None), outbox.open_queue(10, None)
    for text in (b"1", b"2"):
        queue.put(Item(text), more=True)
    assert outbox.take(1) == [b"1"]
    other.put(Item(b"3"))
    assert socket.written == []


def test_an_entry_that_others_follow_waits_for_them():
    outbox = Outbox(1000)
    socket = Socket(outbox)
    queue = outbox.open_queue(10, None)
    for text in (b"1", b"2"):
        queue.put(Item(text), more=True)
    assert (socket.written, outbox.take(EVERYTHING)) == ([], [b"1", b"2"])


def test_an_entry_that_is_not_ready_waits_in_its_queue():
    outbox = Outbox(1000)
    socket = Socket(outbox)
    queue = outbox.open_queue(1, None)
    item = Item(b"1", ready=False)
    queue.put(item)
    item.ready = True
    assert (socket.written, outbox.take(EVERYTHING)) == ([], [b"1"])


actions = st.lists(
    st.one_of(
        st.tuples(st.just("put"), st.integers(0, 2), st.integers(1, 60), st.booleans()),
        st.tuples(st.just("take"), st.integers(0, 100)),
        st.tuples(st.just("busy"), st.booleans()),
        st.tuples(st.just("control"), st.integers(1, 20)),
    ),
    max_size=60,
)


@given(actions)
def test_every_entry_is_sent_dropped_or_waiting_and_the_budget_holds(steps):
    outbox = Outbox(100)
    queues = [outbox.open_queue(1, None), outbox.open_queue(3, 50), outbox.open_queue(5, None)]
    socket = Socket(outbox)
    taken = socket.written
    put = control_put = 0
    for step in steps:
        match step:
            case ("put", queue, size, more):
                queues[queue].put(Item(b"%d:%d " % (queue, put) + bytes(size)), more=more)
                put += 1
            case ("busy", is_busy):
                socket.is_busy = is_busy
            case ("control", size):
                outbox.put_control(bytes(size))
                control_put += 1
            case ("take", size):
                taken += outbox.take(size)
        waiting = [len(queue.waiting) for queue in queues]
        assert len(taken) == outbox.sent
        assert put == outbox.sent - outbox.control_sent + outbox.dropped + sum(waiting)
        assert outbox.size <= 100 or sum(waiting) <= 1 or outbox.overflowed
        assert all(count <= queue.depth for count, queue in zip(waiting, queues, strict=True))
        held = sum(_held(queue) for queue in queues)
        assert outbox.size >= held
    taken += outbox.take(EVERYTHING)
    assert outbox.size == 0
    assert outbox.control_sent == control_put
    for queue in range(len(queues)):
        prefix = b"%d:" % queue
        order = [int(frame[2:].split()[0]) for frame in taken if frame.startswith(prefix)]
        assert order == sorted(order)


def _held(queue: Queue) -> int:
    return sum(entry.size for entry in queue.waiting)


def test_entries_that_a_throttle_replaced_are_also_counted_for_closed_queues():
    outbox = Outbox(1000)
    open_queue, closed_queue = outbox.open_queue(1, None), outbox.open_queue(1, None)
    open_queue.coalesced = 2
    closed_queue.coalesced = 3
    outbox.close_queue(closed_queue)
    assert outbox.coalesced == 5
