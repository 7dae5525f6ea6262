# SPDX-License-Identifier: Apache-2.0
"""The package's C# tests, each class of them one of pytest's."""

import contextlib
import json
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import IO, Any, Final

import pytest

from tests.unity import mono, package
from tests.unity.mono import Binary, CompileError
from tests.unity.package import ANDROID, EDITOR, Target

IN_EDITOR: Final = EDITOR.with_everything()
AHEAD_OF_TIME: Final = ANDROID.with_everything()

LIST_TIMEOUT_S: Final = 240
EXIT_TIMEOUT_S: Final = 120  # the rest of a test has that long to end


@dataclass(frozen=True)
class CSharpTest:
    """One NUnit test of a compiled assembly."""

    name: str
    binary: Binary | None = None
    categories: frozenset[str] = frozenset()
    problem: str = ""
    """Why there is nothing to run: the compiler's words."""

    @property
    def class_name(self) -> str:
        """The class that has it."""
        return self.name.partition("(")[0].rpartition(".")[0]

    @property
    def needs_gateway(self) -> bool:
        """Whether it finds a live gateway by its environment."""
        return "Gateway" in self.categories


def parameters(assembly: str, target: Target = IN_EDITOR) -> list[Any]:
    """Return the tests of each class of an assembly as a parameter for pytest.

    Without Mono it is one that is skipped.
    """
    # Mono calls back from its native zlib, and cannot do so without a JIT compiler
    left_out = "Inflates" if target == AHEAD_OF_TIME else ""
    return parameters_of_compiled(assembly, lambda: package.compiled(assembly, target), left_out)


def parameters_of_compiled(
    name: str, compiled: Callable[[], Binary], left_out: str = ""
) -> list[Any]:
    """Like `parameters`, of what `compiled` returns, without the category *left_out*."""
    if reason := mono.missing():
        return [pytest.param([], id=name, marks=pytest.mark.skip(reason=reason))]
    try:
        return by_class(one for one in tests_of(compiled()) if left_out not in one.categories)
    except CompileError as error:
        return [pytest.param([CSharpTest("compiles", problem=str(error))], id="compiles")]


def by_class(tests: Iterable[CSharpTest]) -> list[Any]:
    """Return a parameter for the tests of each class, and another for those that take long."""
    classes: dict[tuple[str, bool], list[CSharpTest]] = {}
    for test in tests:
        classes.setdefault((test.class_name, "Long" in test.categories), []).append(test)
    return [
        pytest.param(each, id=name, marks=[pytest.mark.long] if is_long else [])
        for (name, is_long), each in classes.items()
    ]


@dataclass
class Runner:
    """Runs tests by name, in a process per assembly that serves one after the other."""

    full_aot: bool = False
    _processes: dict[tuple[Binary, frozenset[tuple[str, str]]], "_Process"] = field(
        default_factory=dict
    )

    def check_all(
        self, tests: Iterable[CSharpTest], environment: Callable[[CSharpTest], Mapping[str, str]]
    ) -> None:
        """Run each of the tests. Fail or skip with the words of all that did."""
        failures, skipped = [], []
        for test in tests:
            try:
                self.check(test, environment(test))
            except pytest.fail.Exception as failure:
                failures.append(str(failure))
            except pytest.skip.Exception as skip:
                skipped.append(f"{test.name}: {skip}")
        if failures:
            pytest.fail("\n\n".join(failures), pytrace=False)
        if skipped:
            pytest.skip("only skipped: " + "; ".join(skipped))

    def check(self, test: CSharpTest, env: Mapping[str, str] | None = None) -> None:
        """Run the test, with these variables in its environment. Fail or skip as it did."""
        if test.problem:
            pytest.fail(test.problem, pytrace=False)
        assert test.binary is not None
        env = env or {}
        key = (test.binary, frozenset(env.items()))
        process = self._processes.get(key)
        if process is not None and not process.is_running():
            process.close()
            process = None
        if process is None:
            process = _Process.start(test.binary, self.full_aot, env)
            self._processes[key] = process
        result = process.run(test.name)
        if result["outcome"] == "failed":
            words = f"{test.name}\n{result['message']}\n{result['output']}"
            pytest.fail(words.rstrip(), pytrace=False)
        if result["outcome"] == "skipped":
            pytest.skip(result["message"])

    def close(self) -> None:
        """End all processes."""
        for process in self._processes.values():
            process.close()


@dataclass
class _Process:
    process: "subprocess.Popen[str]"
    errors: IO[str]

    @classmethod
    def start(cls, binary: Binary, full_aot: bool, env: Mapping[str, str]) -> "_Process":
        runner = package.runner()
        if full_aot:
            runner, binary = mono.ahead_of_time(runner), mono.ahead_of_time(binary)
        errors = tempfile.TemporaryFile("w+")  # noqa: SIM115  # closed with the process
        return cls(
            subprocess.Popen(
                mono.command(runner, "--serve", str(binary.path), full_aot=full_aot),
                env={**mono.environment(runner, binary), **env},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
            ),
            errors,
        )

    def is_running(self) -> bool:
        return self.process.poll() is None

    def run(self, name: str) -> dict[str, Any]:
        try:
            self.process.stdin.write(f"{name}\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            line = ""
        else:
            line = self.process.stdout.readline()
        if not line:
            self.process.wait(EXIT_TIMEOUT_S)
            pytest.fail(f"{name}: the process ended in it\n{self._errors()}", pytrace=False)
        try:
            result: dict[str, Any] = json.loads(line)
        except json.JSONDecodeError:
            # Mono writes its own crash report there. It ends after that
            report = line + self.process.stdout.read()
            pytest.fail(f"{name}: the process crashed in it\n{report}", pytrace=False)
        if result["last"]:
            self.process.wait(EXIT_TIMEOUT_S)
        if errors := self._errors():
            result["output"] += f"\nstandard error:\n{errors}"
        if result["name"] != name:
            pytest.fail(f"asked for {name}, got {result}", pytrace=False)
        return result

    def close(self) -> None:
        try:
            with contextlib.suppress(BrokenPipeError):  # it has ended by itself
                self.process.stdin.close()
            self.process.wait(EXIT_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        finally:
            self.process.stdout.close()
            self.errors.close()

    def _errors(self) -> str:
        self.errors.seek(0)
        text = self.errors.read()
        self.errors.seek(0)
        self.errors.truncate()
        return text


def tests_of(binary: Binary) -> list[CSharpTest]:
    runner = package.runner()
    listing = subprocess.run(
        mono.command(runner, "--list", str(binary.path)),
        env=mono.environment(runner, binary),
        capture_output=True,
        text=True,
        timeout=LIST_TIMEOUT_S,
        check=False,
    )
    if listing.returncode != 0:
        raise CompileError(f"{binary.name}'s tests cannot be listed:\n{listing.stderr}")
    tests = [json.loads(line) for line in listing.stdout.splitlines()]
    return [CSharpTest(test["name"], binary, frozenset(test["categories"])) for test in tests]
