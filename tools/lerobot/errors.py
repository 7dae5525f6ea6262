# SPDX-License-Identifier: Apache-2.0
"""The errors of the conversion, each with a sentence for its user."""

from gateway.errors import GatewayError


class ConversionError(GatewayError):
    """Raised when there can be no dataset."""


class LeftOutError(GatewayError):
    """Raised when an episode cannot be in the dataset. The text completes "it is left out"."""
