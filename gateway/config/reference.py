# SPDX-License-Identifier: Apache-2.0
"""The reference of all settings, as Markdown."""

import inspect
import re
from collections.abc import Iterable, Iterator
from itertools import groupby
from operator import attrgetter

from gateway.config.model import Config
from gateway.config.settings import Setting, settings, toml_value

_EXAMPLE = re.compile(r"(?<!\S)(\S*[*/]\S*?)(?=,?(?:\s|$))")  # Markdown would change it
_HEAD = "| Setting | Default | Values | What it does |\n|---|---|---|---|"


def reference() -> str:
    """Return a table of settings for each section of the configuration."""
    return "\n".join(_sections())


def _sections() -> Iterator[str]:
    for name, group in groupby(settings(), lambda setting: setting.key.rpartition(".")[0]):
        title = f"`{name}`" if name else "Top level"
        yield f"### {title}\n\n{_purpose(name)}\n\n{_table(group)}"


def _purpose(name: str) -> str:
    """Return the first paragraph of a section's docstring."""
    section = attrgetter(name)(Config()) if name else Config()
    return (inspect.getdoc(section) or "").partition("\n\n")[0]


def _table(group: Iterable[Setting]) -> str:
    return "\n".join([_HEAD, *map(_row, group)]) + "\n"


def _row(setting: Setting) -> str:
    default = setting.field.default
    shown = "unset" if default is None else f"`{toml_value(default)}`"
    values = _EXAMPLE.sub(r"`\1`", setting.expectation)
    return f"| `{setting.key}` | {shown} | {values} | {setting.description} |"
