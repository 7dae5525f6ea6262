# SPDX-License-Identifier: Apache-2.0
"""Values that a client of the core has as CDR, and that nobody has to decode."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RawValues:
    """The values of a message, a call or a goal as CDR. The answers are CDR as well."""

    cdr: bytes
