# SPDX-License-Identifier: Apache-2.0
"""The error of a recording that cannot be played."""

from gateway.errors import GatewayError


class RecordingError(GatewayError):
    """Raised when a recording cannot be opened or read. The text names the file and a remedy."""
