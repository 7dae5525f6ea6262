# SPDX-License-Identifier: Apache-2.0
"""One target under atheris, in a separate process, started by `python -m tests.fuzz`.

It goes on after a fault, and keeps the first bytes of each kind, and the slowest.
"""

import hashlib
import heapq
import importlib
import sys
import traceback
from pathlib import Path

import atheris

from tests.fuzz.faults import signature
from tests.fuzz.stopwatch import STOPWATCH

MAX_COMPILED = 600  # generated functions that are instrumented. Each takes counters for good
LONGEST_CODE_BYTES = 4000  # atheris takes the square of it: a minute for the longest decoders
SLOWEST = 8


def instrument_generated_code() -> None:
    """Instrument the compiled codecs."""
    source = importlib.import_module("gateway.codec.cdr.source").SourceCode
    plain = source.compile
    count = 0

    def compile_instrumented(self, *arguments):
        nonlocal count
        compiled = plain(self, *arguments)
        if count >= MAX_COMPILED or len(compiled.__code__.co_code) > LONGEST_CODE_BYTES:
            return compiled
        count += 1
        return atheris.instrument_func(compiled)

    source.compile = compile_instrumented


def main() -> None:
    name, folder, *options = sys.argv[1:]
    faults, slow = Path(folder, "faults"), Path(folder, "slow")
    with atheris.instrument_imports(include=["gateway", "schemas"]):
        instrument_generated_code()
        target = importlib.import_module(f"tests.fuzz.targets.{name}").TARGET
    known: set[str] = set()
    slowest: list[tuple[float, str]] = []

    def try_one(data: bytes) -> None:
        took_s = 0.0
        try:
            took_s = STOPWATCH.longest_s(lambda: target.run(data))
        except Exception as error:
            kind = signature(error)
            if kind not in known:
                known.add(kind)
                digest = hashlib.sha256(kind.encode()).hexdigest()[:12]
                (faults / digest).write_bytes(data)
                print(f"{digest}: {traceback.format_exc(limit=-6)}", file=sys.stderr)
        if len(slowest) < SLOWEST or took_s > slowest[0][0]:
            digest = hashlib.sha256(data).hexdigest()[:12]
            (slow / digest).write_bytes(data)
            heapq.heappush(slowest, (took_s, digest))
            if len(slowest) > SLOWEST:
                (slow / heapq.heappop(slowest)[1]).unlink(missing_ok=True)

    atheris.Setup([sys.argv[0], *options], try_one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
