# SPDX-License-Identifier: Apache-2.0
"""The source of one function, while it is written and compiled."""

import linecache
import weakref
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from gateway.codec.cdr.layout import Path


class SourceCode:
    """The lines of a function and the constants that they use."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._indent = 0
        self._constants: dict[str, object] = {}
        self._comments: list[str] = []

    def line(self, text: str) -> None:
        """Write one line at the present indentation."""
        self._lines.append("    " * self._indent + text)

    @contextmanager
    def block(self, head: str) -> Iterator[None]:
        """Write *head* and indent the lines that are written inside."""
        self.line(head)
        self._indent += 1
        yield
        self._indent -= 1

    def constant(self, prefix: str, value: object, meaning: str) -> str:
        """Add a constant and return its name, *prefix* and a running number.

        *meaning* is a comment above the function, for readers of its source.
        """
        name = f"{prefix}_{len(self._constants)}"
        self._constants[name] = value
        self._comments.append(f"# {name}: {meaning}")
        return name

    def compile(self, function: str, title: str, names: Mapping[str, object]) -> Callable[..., Any]:
        """Compile the lines, which define *function*. *names* are its further globals.

        Tracebacks show the source as long as the function exists.
        """
        filename = f"<{title}>"
        text = "\n".join([*self._comments, *self._lines]) + "\n"
        # The text is generated from parsed definitions, whose names are letters and digits.
        code = compile(text, filename, "exec")
        scope: dict[str, Any] = {**names, **self._constants}
        exec(code, scope)  # noqa: S102
        compiled: Callable[..., Any] = scope[function]
        linecache.cache[filename] = (len(text), None, text.splitlines(keepends=True), filename)
        # Clients choose fields, so titles are unbounded: an entry ends with its function.
        weakref.finalize(compiled, linecache.cache.pop, filename, None).atexit = False
        return compiled


def variable(path: Path) -> str:
    """Return the local variable for a field: no two paths share one, none is a keyword."""
    return "m_" + "__".join(path)
