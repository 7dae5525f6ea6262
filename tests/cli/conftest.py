# SPDX-License-Identifier: Apache-2.0
"""The command line in this process, which is faster than a process for each."""

import signal
from collections.abc import Callable, Iterator

import pytest

from gateway.cli import main as cli
from gateway.ending_signals import ENDING


@pytest.fixture
def restored_signals() -> Iterator[None]:
    handlers = {number: signal.getsignal(number) for number in ENDING}
    yield
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.fixture
def refused(
    restored_signals: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str]]:
    """Return a function that runs a command here: its exit code, and its one sentence."""

    def run(*arguments: str, **environment: str) -> tuple[int, str]:
        with monkeypatch.context() as patch:
            for name, value in environment.items():
                patch.setenv(name, value)
            try:
                code = cli.main(list(arguments))
            except SystemExit as ended:
                code = ended.code
        printed = capsys.readouterr()
        assert printed.out == ""
        (line,) = printed.err.splitlines()
        return code, line.removeprefix("ros2-gateway: ")

    return run
