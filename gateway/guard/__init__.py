# SPDX-License-Identifier: Apache-2.0
"""The guard: a separate process that stops the robot when the gateway cannot.

``python -m gateway.guard`` has its own DDS participant, or its own session with a Zenoh router. It
reads a pipe that the gateway writes.
It publishes commands to stop in two cases while something moves:

- The pipe ends, because the gateway was killed.
- The gateway says nothing for longer than the deadline. It is stopped, its event loop is blocked,
  or another thread keeps the GIL.

Both pipes carry one JSON array a line, of at most `MAX_LINE_BYTES`.

From the gateway to the guard, on its standard input:

- ``["open", TOPIC, TYPE, NUMBER, ID...]``: create a publisher. The guard answers ``failed``, or
  ``opened`` once the subscriptions with these ids are discovered, or `DISCOVERY_S` has passed. If
  the topic is open, wait for these ids from now on.
- ``["prove", TOPIC, STAMP_NS, FRAME]``: publish zeros until every reliable subscription has
  acknowledged one, or `PROOF_S` has passed. The guard answers ``proved``.
- ``["moving", TOPIC, STAMP_NS, FRAME]``: a command to move is about to go out, or a zero of a stop
  that has not ended. STAMP_NS is ROS time less the monotonic clock. Both are for the header of a
  TwistStamped.
- ``["rest", TOPIC]``: the last zero has gone out, and there is nothing to watch.
- ``["close", TOPIC]``: destroy the publisher.
- The end of the file: stop every topic that moves, then end.

From the guard to the gateway, on its standard output:

- ``["ready"]``: it takes part in ROS.
- ``["opened", TOPIC, NUMBER]``: it has discovered the subscriptions of this ``open``.
- ``["proved", TOPIC, NUMBER]``: its zeros reach them.
- ``["failed", TOPIC, REASON]``: it cannot.
- ``["heard"]``: it has read its input, at most once per ``HEARD_S``.
- ``["stopped", TOPIC]``: the gateway was silent, and it has begun a stop.
- ``["cut off"]``: commands do not get through to the robot, and the guard ends.

The map is docs/contributing/architecture.md.
"""

from typing import Final

MAX_LINE_BYTES: Final = 4096  # a topic of 250 characters and a frame of 256, six bytes each
# Each takes 35 bytes of a line. If a topic has more, the guard waits only for these.
MAX_READERS: Final = 100
HEARD_S: Final = 0.1
# Beyond the deadline, until the guard acts: a gateway that is only late must stop by itself.
MARGIN_S: Final = 0.075
# `moving` may be left out if one was sent within this time: it is part of the margin.
REPEAT_S: Final = 0.02
# A zero reaches only a node that has discovered the guard. A lost announcement of a participant is
# repeated after 3 s (leaseDuration_announcementperiod of Fast DDS).
DISCOVERY_S: Final = 4.0
# If the guard has discovered a subscription, the robot may not have discovered the guard: Fast DDS
# repeats an announcement of a publisher after a second. A subscription of a killed process never
# acknowledges anything, and is matched for another 20 s.
PROOF_S: Final = 1.5
