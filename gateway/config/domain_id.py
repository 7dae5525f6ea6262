# SPDX-License-Identifier: Apache-2.0
"""The range of DDS domains."""

import re
from typing import Final

MAX_DOMAIN_ID: Final = 232  # the UDP ports of domain 233 would be beyond 65535
DOMAIN_ID_EXPECTATION: Final = f"an integer from 0 to {MAX_DOMAIN_ID}"


def is_domain_id(text: str) -> bool:
    """Return whether a text is the number of a domain."""
    return bool(re.fullmatch("[0-9]{1,3}", text)) and int(text) <= MAX_DOMAIN_ID
