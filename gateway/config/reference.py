# SPDX-License-Identifier: Apache-2.0
"""All settings with their meanings: the reference in Markdown, and an example file."""

import inspect
import re
import textwrap
from collections.abc import Iterable, Iterator
from itertools import groupby
from operator import attrgetter

from gateway.config.model import Config
from gateway.config.settings import Setting, settings, toml_value

_EXAMPLE = re.compile(r"(?<!\S)(\S*[*/]\S*?)(?=,?(?:\s|$))")  # Markdown would change it
_COLUMNS = 96
_EXAMPLE_HEAD = """\
# The configuration of ros2-gateway on this machine. To change a setting, remove its `#`.
# Check the result with `ros2-gateway check-config`. Restart the gateway to apply it.
# Files in config.d/*.toml override this file, in the order of their names.
# Put no secrets here. `ros2-gateway token create NAME` makes a token.
"""
_HEAD = "| Setting | Default | Values | What it does |\n|---|---|---|---|"


def reference() -> str:
    """Return a table of settings for each section of the configuration."""
    return "\n".join(_sections())


def example() -> str:
    """Return a file in which every setting is a comment with its default.

    Without the ``#`` before each setting, it has all defaults.
    """
    return "\n".join([_EXAMPLE_HEAD, *_example_sections()])


def _example_sections() -> Iterator[str]:
    for name, group in _groups():
        title = [f"[{name}]"] if name else []
        about = textwrap.wrap(_purpose(name), _COLUMNS, initial_indent="# ", subsequent_indent="# ")
        yield "\n".join([*title, *about, "", *map(_example_setting, group)])


def _example_setting(setting: Setting) -> str:
    unit = f", {setting.unit}" if setting.unit else ""
    text = f"{setting.description} Values: {setting.expectation}{unit}."
    about = textwrap.wrap(text, _COLUMNS, initial_indent="# ", subsequent_indent="# ")
    name, default = setting.key.rpartition(".")[2], setting.field.default
    shown = f"# {name} =  # unset" if default is None else f"#{name} = {toml_value(default)}"
    return "\n".join([*about, shown, ""])


def _groups() -> Iterable[tuple[str, Iterable[Setting]]]:
    return groupby(settings(), lambda setting: setting.key.rpartition(".")[0])


def _sections() -> Iterator[str]:
    for name, group in _groups():
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
