# SPDX-License-Identifier: Apache-2.0
"""The range of DDS domains."""

import re
from typing import Final

MAX_DOMAIN_ID: Final = 232  # DDS maps domains to UDP ports, and those of 233 do not exist
DOMAIN_ID_EXPECTATION: Final = f"an integer from 0 to {MAX_DOMAIN_ID}"


def is_domain_id(text: str) -> bool:
    """Return whether the text of a flag or a variable names a domain."""
    return bool(re.fullmatch("[0-9]{1,3}", text)) and int(text) <= MAX_DOMAIN_ID
