# SPDX-License-Identifier: Apache-2.0
"""The targets of fuzzing: one module for each, with its name."""

import importlib
from pathlib import Path

from tests.fuzz.target import Target

NAMES = tuple(
    sorted(path.stem for path in Path(__file__).parent.glob("*.py") if path.stem != "__init__")
)


def load(name: str) -> Target:
    """Import a target, and with it the product: a fuzzer instruments what it imports first."""
    found: Target = importlib.import_module(f"{__name__}.{name}").TARGET
    return found
