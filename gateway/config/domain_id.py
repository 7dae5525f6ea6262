# SPDX-License-Identifier: Apache-2.0
"""Which DDS domains there are."""

import re
from typing import Final

MAX_DOMAIN_ID: Final = 232  # DDS maps domains to UDP ports, and those of 233 do not exist
DOMAIN_ID_EXPECTATION: Final = f"an integer from 0 to {MAX_DOMAIN_ID}"


def is_domain_id(text: str) -> bool:
    """Whether a flag's or a variable's text names a domain."""
    return bool(re.fullmatch("[0-9]{1,3}", text)) and int(text) <= MAX_DOMAIN_ID
