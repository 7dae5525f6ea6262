# SPDX-License-Identifier: Apache-2.0
"""``ros2-gateway demo`` that lets commands come late, for tests that drive while a machine is busy.

It stands still for a second now and then, and the gateway rightly refuses what was held up. Only a
longer pause counts here. The deadline and the lease are as ever, because tests are about them.
"""

from gateway.drive import burst, freshness
from gateway.guard import supervisor
from tests.patient_gateway import main

if __name__ == "__main__":
    freshness.MAX_AGE_NS = 2 * 10**9  # type: ignore[misc]  # final everywhere else
    burst.BACKLOG = 1000  # type: ignore[misc]
    supervisor.MARGIN_S = 30  # type: ignore[misc]
    supervisor.UNANSWERED_S = 60  # type: ignore[misc]
    main()
