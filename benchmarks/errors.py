# SPDX-License-Identifier: Apache-2.0
"""The error of a measurement."""


class BenchmarkError(RuntimeError):
    """A process did not do its part, or a request makes no sense. The text says which."""
