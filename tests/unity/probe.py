# SPDX-License-Identifier: Apache-2.0
"""The package's formats under Mono, asked from Python by programs that answer lines."""

import base64
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tests.unity import mono
from tests.unity.mono import Binary

JSON: Final = "json_probe"
JPEG: Final = "jpeg_probe"
EXIT_TIMEOUT_S: Final = 120
# Less than a pipe holds, so that nobody waits to write while the other does not read.
_CHUNK_BYTES: Final = 32_768


class ProbeFailedError(AssertionError):
    """Another exception came out than the format's own. The text is what."""


@dataclass(frozen=True)
class Refusal:
    """The text of a JsonFormatException, or of a JpegFormatException."""

    text: str


Answer = bytes | Refusal
Question = tuple[str, bytes]


class Probe:
    """One process. `close` ends it. The library is what it asks, with what that refers to."""

    def __init__(self, library: Binary, name: str = JSON, *, full_aot: bool = False) -> None:
        sources = sorted((Path(__file__).parent / name).glob("*.cs"))
        references = list(library.closure())
        program = mono.compile_assembly(f"{name}.exe", sources, references=references)
        if full_aot:
            program = mono.ahead_of_time(program)
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  # closed with the process
        self._process = subprocess.Popen(
            mono.command(program, full_aot=full_aot),
            env=mono.environment(program),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
        )

    def ask(self, operation: str, argument: bytes = b"") -> Answer:
        """Ask one question."""
        return self.ask_all([(operation, argument)])[0]

    def ask_all(self, questions: Iterable[Question]) -> list[Answer]:
        """Ask many, in far less time than one by one.

        Raises:
            ProbeFailedError: an exception came out that should not, or the process ended.
        """
        answers: list[Answer] = []
        waiting: list[Question] = []
        size = 0
        for question in questions:
            waiting.append(question)
            size += len(question[1]) * 2 + 100
            if size > _CHUNK_BYTES:
                answers += self._exchange(waiting)
                waiting, size = [], 0
        return answers + self._exchange(waiting)

    def peak_bytes(self) -> int:
        """Return how much memory the process has had at most."""
        status = Path(f"/proc/{self._process.pid}/status").read_text()
        return int(status.partition("VmHWM:")[2].split()[0]) * 1024

    def close(self) -> None:
        """End the process."""
        try:
            self._process.communicate(timeout=EXIT_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()
        self._errors.close()

    def _exchange(self, questions: Sequence[Question]) -> list[Answer]:
        lines = [f"{name} {base64.b64encode(value).decode()}\n" for name, value in questions]
        try:
            self._process.stdin.write(("".join(lines) + "\n").encode())
            self._process.stdin.flush()
        except BrokenPipeError:
            pass  # the first line that is missing tells
        return [self._answer(question, self._process.stdout.readline()) for question in questions]

    def _answer(self, question: Question, line: bytes) -> Answer:
        value = base64.b64decode(line[1:])
        if line.startswith(b"="):
            return value
        if line.startswith(b"!"):
            return Refusal(value.decode())
        self._errors.seek(0)
        what = value.decode() or f"the probe ended\n{self._errors.read().decode()}"
        raise ProbeFailedError(f"{question[0]} {question[1][:200]!r}: {what}")
