# SPDX-License-Identifier: Apache-2.0
"""The codes with which the gateway closes a WebSocket: RFC 6455, 7.4, and its own from 4000 on.

docs/reference/errors.md explains each.
"""

from typing import Final

GOING_AWAY: Final = 1001
PROTOCOL_ERROR: Final = 1002
INVALID_DATA: Final = 1007
POLICY_VIOLATION: Final = 1008
MESSAGE_TOO_BIG: Final = 1009
INTERNAL_ERROR: Final = 1011
OVER_CAPACITY: Final = 1013
UNAUTHENTICATED: Final = 4401
ROLE_REMOVED: Final = 4403
SLOW_CONSUMER: Final = 4503
