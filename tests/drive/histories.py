# SPDX-License-Identifier: Apache-2.0
"""Histories of a drive, in words.

A history is read from the left. Its steps are what comes in, and what must have come out:

- `go`, `slow`, `fast`, `zero`: a command, in a separate turn of the event loop. `[` and `]` enclose
  a turn of several. `go=fresh` has an age, and `b:go` is another client's
- `stream=10`, `zeros=10`: so many commands at 20 Hz
- `500ms`: time passes, and the drive is called when it wants. `freeze=500`: it is not called
- `b:leave`, `guard=lost` and the like: what else may happen
- `>go,zero*4`: what went out since the last look. `stops`: zeros alone. `still`: at most zeros
- `refused=`, `causes=`: the codes of refusals, and the causes of stops, since the last look
- `is=tripped`, `holder=a` and the like: the drive's state
- `forget`: nothing of what came out is looked at
"""

from collections.abc import Callable, Iterable
from dataclasses import replace

from gateway.drive.drive import Drive
from gateway.drive.effects import Changed, Command, Effect, Refused, Rules, Send, Stopped
from gateway.drive.velocity import ZERO, Velocity

MS = 1_000_000
AHEAD = Velocity(linear_x=0.2)
RULES = Rules(500 * MS, 2000 * MS, max_linear=10.0, max_angular=10.0, first_command="any")
VELOCITIES = {
    "zero": ZERO,
    "go": AHEAD,
    "slow": Velocity(linear_x=0.1),
    "fast": Velocity(linear_x=0.3),
}
OF_A_CLIENT = ("leave", "revoke", "release", "invalid", "stop", "acquire")
FACTS: dict[str, Callable[[Drive], bool]] = {
    "tripped": lambda drive: drive.status.is_tripped,
    "free": lambda drive: not drive.status.is_tripped,
    "moving": lambda drive: drive.status.motion == "moving",
    "stopped": lambda drive: drive.status.motion == "stopped",
    "guarded": lambda drive: drive.needs_guard,
    "unguarded": lambda drive: not drive.needs_guard,
    "unproved": lambda drive: drive.waits_for_proof,
    "proved": lambda drive: not drive.waits_for_proof,
}


def expanded(items: str) -> list[str]:
    """Write out `a,b*3`."""
    counted = [item.partition("*") for item in items.split(",") if item]
    return [name for name, _, count in counted for _ in range(int(count or 1))]


class Stage:
    """A drive, its clock, and what came out of it."""

    def __init__(self, guard: str = "ready", **rules: object) -> None:
        self.drive = Drive("/cmd_vel", replace(RULES, **rules), guard)  # type: ignore[arg-type]
        self.now = 1_000_000 * MS
        self.out: list[Effect] = []
        self.is_in_turn = False

    def play(self, history: str) -> None:
        for step in history.split():
            if step[0] == ">":
                assert self.look() == [VELOCITIES[name] for name in expanded(step[1:])], step
                continue
            for each in expanded(step) if "=" not in step else [step]:
                self.step(each)

    def step(self, step: str) -> None:
        what, _, argument = step.partition("=")
        who, _, name = what.rpartition(":")
        client = who or "a"
        if name in VELOCITIES:
            self.command(VELOCITIES[name], client, argument or "unknown")
        elif name in OF_A_CLIENT:
            self.take(getattr(self.drive, name)(client, self.now))
        elif name in {"stream", "zeros"}:
            for _ in range(int(argument)):
                self.command(AHEAD if name == "stream" else ZERO, client)
                self.wait(50)
        elif name.endswith("ms"):
            self.wait(float(name.removesuffix("ms")))
        else:
            getattr(self, {"[": "begin", "]": "end"}.get(name, name))(
                *[argument] if argument else ()
            )

    def take(self, effects: Iterable[Effect]) -> None:
        self.out += effects

    def command(self, velocity: Velocity, client: str = "a", age: str = "unknown") -> None:
        self.take(self.drive.command(Command(client, velocity, age), self.now))  # type: ignore[arg-type]
        if not self.is_in_turn:
            self.end()

    def begin(self) -> None:
        self.is_in_turn = True

    def end(self) -> None:
        self.is_in_turn = False
        self.take(self.drive.end_turn(self.now))

    def tick(self) -> None:
        self.take(self.drive.tick(self.now))

    def wait(self, milliseconds: float) -> None:
        end = self.now + round(milliseconds * MS)
        while (due := self.drive.due_ns) is not None and due <= end:
            self.now = max(self.now, due)
            self.tick()
        self.now = end

    def freeze(self, milliseconds: str) -> None:
        self.now += round(float(milliseconds) * MS)

    def guard(self, state: str) -> None:
        self.take(self.drive.set_guard(state, self.now))  # type: ignore[arg-type]

    def shutdown(self) -> None:
        self.take(self.drive.shut_down(self.now))

    # Looks at what came out

    def look(self) -> list[Velocity]:
        sent = [each.velocity for each in self.out if isinstance(each, Send)]
        self.out = []
        return sent

    forget = look

    def still(self) -> None:
        assert set(self.look()) <= {ZERO}

    def stops(self) -> None:
        assert set(self.look()) == {ZERO}

    def of(self, kind: type, name: str) -> list[str]:
        return [getattr(each, name) for each in self.out if isinstance(each, kind)]

    def refused(self, codes: str) -> None:
        assert self.of(Refused, "code") == expanded(codes.replace("none", ""))

    def says(self, words: str) -> None:
        """Look for some words, with underscores between them, in the reason of each refusal."""
        reasons = self.of(Refused, "reason")
        assert reasons
        assert all(words.replace("_", " ") in reason for reason in reasons), reasons

    def causes(self, causes: str) -> None:
        assert self.of(Stopped, "cause") == expanded(causes.replace("none", ""))

    def changes(self, answer: str) -> None:
        assert any(isinstance(each, Changed) for each in self.out) == (answer == "yes")

    def holder(self, client: str) -> None:
        assert self.drive.status.holder == (None if client == "none" else client)

    def fact(self, name: str) -> None:
        assert FACTS[name](self.drive), name


setattr(Stage, "is", Stage.fact)
