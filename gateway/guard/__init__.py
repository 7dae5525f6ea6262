# SPDX-License-Identifier: Apache-2.0
"""The guard: a process of its own that stops the robot when the gateway cannot.

``python -m gateway.guard`` has a DDS participant of its own and reads a pipe that the gateway
writes. It publishes commands to stop when the pipe ends while something moves (the gateway was
killed), or when the gateway says nothing for longer than the deadline (it is stopped, or its event
loop is blocked, or another thread keeps the GIL).

The pipes, both ways: one JSON array a line, at most `MAX_LINE_BYTES`.

=========================================  =======================================================
gateway to guard, on its standard input
=========================================  =======================================================
``["open", TOPIC, TYPE, READERS]``         create a publisher; answered by ``failed``, or by
                                           ``opened`` once discovery has matched so many
                                           subscriptions, or has had `DISCOVERY_S` for it. Of a
                                           topic that is open it waits for so many now
``["moving", TOPIC, STAMP_NS, FRAME]``     a command to move is about to go out, or a zero of a
                                           stop that has not ended. STAMP_NS is ROS time less the
                                           monotonic clock; both are for the header of a
                                           TwistStamped
``["rest", TOPIC]``                        the last zero has gone out: nothing to watch
``["close", TOPIC]``                       destroy the publisher
end of file                                stop what moves, then end
=========================================  =======================================================

=========================================  =======================================================
guard to gateway, on its standard output
=========================================  =======================================================
``["ready"]``                              it takes part in ROS
``["opened", TOPIC]``                      it can stop this topic
``["failed", TOPIC, REASON]``              it cannot
``["heard"]``                              it has read what came; at most one for each ``HEARD_S``
``["stopped", TOPIC]``                     the gateway was silent, and it has begun a stop
=========================================  =======================================================

The map is docs/architecture.md.
"""

from typing import Final

MAX_LINE_BYTES: Final = 4096  # a topic of 250 characters and a frame of 256, six bytes each
HEARD_S: Final = 0.1
# Beyond the deadline, until the guard acts: a gateway that is merely late shall stop by itself.
MARGIN_S: Final = 0.075
# `moving` may be left out if one was sent within this time: it is part of the margin.
REPEAT_S: Final = 0.02
# A zero reaches only who has discovered the guard; one announcement of a participant that is lost
# takes 3 s to be repeated (leaseDuration_announcementperiod of Fast DDS).
DISCOVERY_S: Final = 4.0
