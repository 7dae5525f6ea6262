# SPDX-License-Identifier: Apache-2.0
"""What can go wrong with a measurement."""


class BenchmarkError(RuntimeError):
    """A process did not do its part, or a request makes no sense; the text says which."""
