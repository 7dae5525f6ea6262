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
``["open", TOPIC, TYPE, NUMBER, ID...]``   create a publisher; answered by ``failed``, or by
                                           ``opened`` once the subscriptions with these ids are
                                           discovered, or `DISCOVERY_S` has passed. Of a topic
                                           that is open it waits for these from now on
``["prove", TOPIC, STAMP_NS, FRAME]``      publish zeros until every reliable subscription has
                                           acknowledged one, or `PROOF_S` has passed; answered by
                                           ``proved``
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
``["opened", TOPIC, NUMBER]``              it has discovered the subscriptions of this ``open``
``["proved", TOPIC, NUMBER]``              its zeros reach them
``["failed", TOPIC, REASON]``              it cannot
``["heard"]``                              it has read what came; at most one for each ``HEARD_S``
``["stopped", TOPIC]``                     the gateway was silent, and it has begun a stop
=========================================  =======================================================

The map is docs/contributing/architecture.md.
"""

from typing import Final

MAX_LINE_BYTES: Final = 4096  # a topic of 250 characters and a frame of 256, six bytes each
# Each takes 35 bytes of a line. A topic that has more is not waited for until all are discovered.
MAX_READERS: Final = 100
HEARD_S: Final = 0.1
# Beyond the deadline, until the guard acts: a gateway that is merely late shall stop by itself.
MARGIN_S: Final = 0.075
# `moving` may be left out if one was sent within this time: it is part of the margin.
REPEAT_S: Final = 0.02
# A zero reaches only who has discovered the guard; one announcement of a participant that is lost
# takes 3 s to be repeated (leaseDuration_announcementperiod of Fast DDS).
DISCOVERY_S: Final = 4.0
# That the guard has discovered a subscription does not mean that the robot has discovered the
# guard: Fast DDS repeats what it says about publishers after a second. A subscription of a process
# that was killed never acknowledges anything, and is matched for another 20 s.
PROOF_S: Final = 1.5
