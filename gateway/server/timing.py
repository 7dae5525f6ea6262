# SPDX-License-Identifier: Apache-2.0
"""How long the server waits for a peer."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Timing:
    """Times in seconds."""

    open_timeout_s: float = 5.0  # from TCP accept to the end of the handshake
    ping_interval_s: float = 5.0  # of silence, before a ping asks whether the peer is there
    ping_timeout_s: float = 5.0  # without a pong; a headset that sleeps is gone
    send_deadline_s: float = 5.0  # without the peer taking a single byte
    slow_consumer_s: float = 5.0  # with more than half of the send queue in use
    close_timeout_s: float = 1.0  # for the closing handshake; shutdown has 2 s in all


TICK_S = 0.25  # how exactly the times above are kept; 4 wake-ups a second are not measurable
