# SPDX-License-Identifier: Apache-2.0
"""The sources of the configuration: flags, then the environment, then a TOML file.

Other settings have their defaults. Every error names the flag, the variable, or the file and key.
"""

import contextlib
import difflib
import json
import reprlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from gateway.config.model import Config
from gateway.config.section import Section
from gateway.errors import ConfigError, system_reason
from schemas.backports import tomllib

PREFIX: Final = "ROS2_GATEWAY_"
FILE_VARIABLE: Final = "ROS2_GATEWAY_CONFIG"
# of clients: `ros2-gateway generate --from` shows it to a gateway
TOKEN_VARIABLE: Final = "ROS2_GATEWAY_TOKEN"  # noqa: S105  # a name


def _variable(key: str) -> str:
    return PREFIX + key.replace(".", "__").upper()


_DEFAULT: Final = "default"
_JSON_TYPES: Final = {
    "integer": "an integer",
    "number": "a number",
    "boolean": "true or false",
    "string": "text",
}


class Given(NamedTuple):
    """One unchecked value from one source. ``is_text`` if the source has only strings."""

    key: str  # dotted, as in limits.max_clients
    value: object
    source: str  # its name for the operator: --port, ROS2_GATEWAY_PORT, gateway.toml
    is_text: bool = True


@dataclass(frozen=True)
class Setting:
    """One field of `Config` by its dotted key."""

    key: str
    field: FieldInfo

    @property
    def variable(self) -> str:
        """The environment variable that sets it."""
        return _variable(self.key)

    @property
    def description(self) -> str:
        """Its meaning, and the effect at the limit."""
        return self.field.description or ""

    @cached_property
    def expectation(self) -> str:
        """A text about its values: ``an integer from 0 to 65535``."""
        schema = self._adapter.json_schema()
        if isinstance(self.field.json_schema_extra, dict):
            schema |= self.field.json_schema_extra
        return _expectation(schema)

    def parse(self, given: Given) -> object:
        """Return the value in the field's type. See `_items` for a text of several values.

        Raises:
            ConfigError: the value is invalid.
        """
        value = given.value
        try:
            if self._is_list and isinstance(value, str) and given.is_text:
                value = _items(value)
            elif self._is_list and isinstance(value, list):
                value = tuple(value)
            elif given.is_text and isinstance(value, str):
                return self._adapter.validate_strings(value)
            return self._adapter.validate_python(value, strict=True)
        except ValidationError as error:
            name = given.source if given.is_text else f"{given.source}: {self.key}"
            got = reprlib.repr(given.value)
            raise ConfigError(f"{name}: got {got}, expected {self.expectation}") from error

    @property
    def _is_list(self) -> bool:
        return isinstance(self.field.default, tuple)

    @cached_property
    def _adapter(self) -> TypeAdapter[Any]:
        parts = (self.field.annotation, Field(), *self.field.metadata)
        form: Any = Annotated
        return TypeAdapter(form[parts])


class Loaded(NamedTuple):
    """A configuration and, by dotted key, the source of each value."""

    config: Config
    origins: Mapping[str, str]


def settings(section: type[Section] = Config, prefix: str = "") -> Iterator[Setting]:
    """List the settings of *section* and of those below, in the order of the model."""
    for name, field in section.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, Section):
            yield from settings(field.annotation, f"{prefix}{name}.")
        else:
            yield Setting(prefix + name, field)


def load(
    flags: Iterable[Given] = (),
    environment: Mapping[str, str] | None = None,
    file: Path | None = None,
) -> Loaded:
    """Load the configuration. A *file* takes precedence over the one that the environment names.

    Raises:
        ConfigError: values are wrong. The error lists every mistake in all sources.
    """
    environment = environment or {}
    if file is None and environment.get(FILE_VARIABLE):
        file = Path(environment[FILE_VARIABLE])
    known = {setting.key: setting for setting in settings()}
    values: dict[str, object] = {}
    origins = dict.fromkeys(known, _DEFAULT)
    problems: list[str] = []
    for given in [
        *(() if file is None else _from_file(file, known, problems)),
        *_from_environment(environment, known, problems),
        *flags,
    ]:
        setting = known.get(given.key)
        if setting is None:
            sections = dict.fromkeys(key.partition(".")[0] for key in known)
            hint = _hint(given.key, [*known, *sections])
            problems.append(f"{given.source}: unknown setting {given.key}{hint}")
            continue
        try:
            values[given.key] = setting.parse(given)
        except ConfigError as error:
            problems.extend(error.problems)
        origins[given.key] = given.source
    if problems:
        raise ConfigError(*problems)
    return Loaded(Config.model_validate(_nested(values)), origins)


def to_toml(loaded: Loaded) -> str:
    """Write a configuration as TOML, with the source next to each value."""
    tables: dict[str, list[str]] = {}
    for setting in settings():
        table, _, name = setting.key.rpartition(".")
        value = _value_at(loaded.config, setting.key)
        # TOML has no null: an unset key is shown as a comment
        assignment = f"# {name} =" if value is None else f"{name} = {toml_value(value)}"
        line = f"{assignment}  # {loaded.origins[setting.key]}"
        tables.setdefault(table, []).append(line)
    parts = [
        "\n".join([f"[{table}]", *lines] if table else lines) for table, lines in tables.items()
    ]
    return "\n\n".join(parts) + "\n"


def _from_file(path: Path, known: Mapping[str, Setting], problems: list[str]) -> Sequence[Given]:
    try:
        with path.open("rb") as file:
            document = tomllib.load(file)
    except OSError as error:
        problems.append(f"cannot read {path}, {system_reason(error)}")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        problems.append(f"{path} is not valid TOML: {error}")
    else:
        return list(_flattened(document, str(path), known, problems))
    return ()


def _flattened(
    table: Mapping[str, object],
    source: str,
    known: Mapping[str, Setting],
    problems: list[str],
    prefix: str = "",
) -> Iterator[Given]:
    for name, value in table.items():
        key = prefix + name
        if not any(other.startswith(f"{key}.") for other in known):
            yield Given(key, value, source, is_text=False)
        elif isinstance(value, dict):
            yield from _flattened(value, source, known, problems, f"{key}.")
        else:
            problems.append(f"{source}: {key}: got {reprlib.repr(value)}, expected a table")


def _from_environment(
    environment: Mapping[str, str], known: Mapping[str, Setting], problems: list[str]
) -> Iterator[Given]:
    by_variable = {_variable(key): key for key in known}
    for variable, value in sorted(environment.items()):
        if variable in by_variable:
            yield Given(by_variable[variable], value, variable)
        elif variable.startswith(PREFIX) and variable not in {FILE_VARIABLE, TOKEN_VARIABLE}:
            hint = _hint(variable, [*by_variable, FILE_VARIABLE])
            problems.append(f"unknown environment variable {variable}{hint}")


def _hint(name: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    return f", did you mean {close[0]}" if close else ""


def _items(text: str) -> tuple[object, ...]:
    """Return the values in a text such as ``a,b`` or ``["a", "b"]``."""
    if text.lstrip().startswith("["):
        with contextlib.suppress(tomllib.TOMLDecodeError):
            return tuple(tomllib.loads(f"items = {text}")["items"])
    return tuple(part.strip() for part in text.split(",") if part)


def _nested(values: Mapping[str, object]) -> dict[str, Any]:
    """Turn dotted keys into tables: ``{"log.level": x}`` into ``{"log": {"level": x}}``."""
    root: dict[str, Any] = {}
    for key, value in values.items():
        *tables, name = key.split(".")
        table = root
        for part in tables:
            table = table.setdefault(part, {})
        table[name] = value
    return root


def _value_at(config: Config, key: str) -> object:
    value: object = config
    for name in key.split("."):
        value = getattr(value, name)
    return value


def toml_value(value: object) -> str:
    """Write a value as TOML."""
    # JSON and TOML write booleans, numbers and printable text alike
    return json.dumps(value, ensure_ascii=False)


def _expectation(schema: Mapping[str, Any]) -> str:
    if "expected" in schema:
        return str(schema["expected"])
    if "enum" in schema:
        *others, last = schema["enum"]
        return f"{', '.join(others)} or {last}"
    if "anyOf" in schema:  # with null, which no source can write: unset it instead
        return next(_expectation(one) for one in schema["anyOf"] if one.get("type") != "null")
    kind = _JSON_TYPES[schema["type"]]
    low, above, high = (schema.get(k) for k in ("minimum", "exclusiveMinimum", "maximum"))
    if low is not None and high is not None:
        return f"{kind} from {low:g} to {high}"
    if above is not None and high is not None:
        return f"{kind} above {above:g} and up to {high:g}"
    if low is not None:
        return f"{kind} of at least {low:g}"
    return kind
