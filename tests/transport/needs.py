# SPDX-License-Identifier: Apache-2.0
"""Marks for tests that need something of the machine."""

import pytest
from websockets.http11 import Request

# the last for Python 3.10 reads GET requests only
needs_websockets_17 = pytest.mark.skipif(
    not hasattr(Request, "method"), reason="needs websockets 17, and so Python 3.11"
)
