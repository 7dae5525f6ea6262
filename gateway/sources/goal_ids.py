# SPDX-License-Identifier: Apache-2.0
"""Goals' ids in CDR, so that a goal and its feedback need not be decoded for them."""

from typing import Final

# A goal's id comes first in SendGoal_Request and in FeedbackMessage. Nothing in CDR is aligned to
# more than 8: what follows the 16 bytes is laid out as it is alone.
_CDR_HEADER_BYTES: Final = 4
_GOAL_ID_END: Final = _CDR_HEADER_BYTES + 16


def with_goal_id(goal_id: bytes, cdr: bytes) -> bytes:
    """Put a goal's id before a Goal or a Feedback, all CDR but the id."""
    return b"".join((cdr[:_CDR_HEADER_BYTES], goal_id, cdr[_CDR_HEADER_BYTES:]))


def goal_id_of(cdr: bytes) -> bytes:
    """Return the goal's id in a FeedbackMessage. Shorter than 16 bytes if that is too short."""
    return cdr[_CDR_HEADER_BYTES:_GOAL_ID_END]


def without_goal_id(cdr: bytes) -> bytes:
    """Return the Feedback of a FeedbackMessage."""
    return cdr[:_CDR_HEADER_BYTES] + cdr[_GOAL_ID_END:]
