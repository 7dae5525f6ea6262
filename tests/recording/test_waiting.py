# SPDX-License-Identifier: Apache-2.0
"""The queue between the event loop and the disk."""

from gateway.recording import waiting
from gateway.recording.entries import RecordedMessage, RecordedTopic
from gateway.recording.waiting import MAX_WAITING, WaitingMessages

CAMERA = RecordedTopic("/camera", "", "", "", "")
ODOMETRY = RecordedTopic("/odom", "", "", "", "")


def message(topic: RecordedTopic, number: int, size: int = 1) -> RecordedMessage:
    return RecordedMessage(number, number, topic, bytes(size))


def test_messages_come_out_in_the_order_in_which_they_came():
    queue = WaitingMessages(100)
    messages = [message(topic, number) for number, topic in enumerate([CAMERA, ODOMETRY] * 3)]
    for each in messages:
        queue.put(each)
    assert queue.take() == messages
    assert queue.take() == []


def test_the_topic_that_has_most_loses_its_oldest_message():
    queue = WaitingMessages(100)
    for number in range(5):
        queue.put(message(ODOMETRY, number))
        queue.put(message(CAMERA, number, 40))
    assert [(each.topic, each.received_ns) for each in queue.take()] == [
        *((ODOMETRY, number) for number in range(3)),
        *((ODOMETRY, 3), (CAMERA, 3)),
        *((ODOMETRY, 4), (CAMERA, 4)),
    ]
    assert queue.dropped() == {"/camera": 3}


def test_messages_that_are_being_written_take_room():
    queue = WaitingMessages(100)
    queue.put(message(CAMERA, 1, 90))
    assert len(queue.take()) == 1
    queue.put(message(CAMERA, 2, 90))
    assert queue.take() == []
    queue.written(1, 90)
    queue.put(message(CAMERA, 3, 90))
    assert len(queue.take()) == 1
    assert queue.dropped() == {"/camera": 1}


def test_many_small_messages_are_too_many():
    assert waiting.MAX_WAITING == 100_000  # 30 MB
    queue = WaitingMessages(MAX_WAITING * 2)
    for number in range(MAX_WAITING + 2):
        queue.put(message(ODOMETRY, number))
    assert queue.dropped() == {"/odom": 2}
    assert len(queue.take()) == MAX_WAITING
