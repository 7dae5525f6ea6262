# SPDX-License-Identifier: Apache-2.0
"""The sources of the configuration: flags, then the environment, then the files.

Other settings have their defaults. Every error names the flag, the variable, or the file, its line,
and the key.
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

from gateway.config.files import FILE_VARIABLE, FOLDER_VARIABLE, Given, read_files
from gateway.config.model import Config
from gateway.config.secrets import ADVICE, TOKEN_PREFIX, is_secret_name
from gateway.config.section import Section
from gateway.errors import ConfigError
from schemas.backports import tomllib

PREFIX: Final = "ROS2_GATEWAY_"
# of clients: `ros2-gateway generate --from` shows it to a gateway
TOKEN_VARIABLE: Final = "ROS2_GATEWAY_TOKEN"  # noqa: S105  # a name
_OTHER_VARIABLES: Final = frozenset({FILE_VARIABLE, FOLDER_VARIABLE, TOKEN_VARIABLE})


def _variable(key: str) -> str:
    return PREFIX + key.replace(".", "__").upper()


_DEFAULT: Final = "default"
_UNITS: Final = {
    "_rad_s": "in rad/s",
    "_m_s": "in m/s",
    "_per_s": "per second",
    "_bytes": "in bytes",
    "_s": "in seconds",
}
_JSON_TYPES: Final = {
    "integer": "an integer",
    "number": "a number",
    "boolean": "true or false",
    "string": "text",
}


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

    @property
    def unit(self) -> str:
        """Its unit, by the end of its name. Empty for a number or text without one."""
        return next((unit for end, unit in _UNITS.items() if self.key.endswith(end)), "")

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
        name = given.source if given.is_text else f"{given.source}: {self.key}"
        if isinstance(value, str) and value.startswith(TOKEN_PREFIX):
            raise ConfigError(f"{name}: got a token, but {ADVICE}")
        try:
            if self._is_list and isinstance(value, str) and given.is_text:
                value = _items(value)
            elif self._is_list and isinstance(value, list):
                value = tuple(value)
            elif given.is_text and isinstance(value, str):
                return self._adapter.validate_strings(value)
            return self._adapter.validate_python(value, strict=True)
        except ValidationError as error:
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
    files: Sequence[Path] = ()  # that were read, later ones override earlier ones
    ignored: Sequence[Path] = ()  # of the folder of drop-ins

    def located(self, error: ConfigError) -> ConfigError:
        """Return the problems with the sources of the settings that they begin with."""
        return ConfigError(*map(self._located, error.problems))

    def _located(self, problem: str) -> str:
        origin = self.origins.get(problem.partition(":")[0].partition(",")[0], _DEFAULT)
        is_near = origin == _DEFAULT or origin.startswith("--")  # in the line that was just typed
        return problem if is_near else f"{origin}: {problem}"


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
    *,
    only_named: bool = False,
) -> Loaded:
    """Load the configuration. A *file* takes precedence over the one that the environment names.

    The files of this machine are below both. With *only_named*, they are not read.

    Raises:
        ConfigError: values are wrong. The error lists every mistake in all sources.
    """
    environment = environment or {}
    known = {setting.key: setting for setting in settings()}
    values: dict[str, object] = {}
    origins = dict.fromkeys(known, _DEFAULT)
    files = read_files(environment, file, known, only_named=only_named)
    problems = files.problems
    for given in [
        *files.given,
        *_from_environment(environment, known, problems),
        *flags,
    ]:
        setting = known.get(given.key)
        if setting is None:
            problems.append(f"{given.source}: {_unknown(given.key, known)}")
            continue
        try:
            values[given.key] = setting.parse(given)
        except ConfigError as error:
            problems.extend(error.problems)
        origins[given.key] = given.source
    if problems:
        raise ConfigError(*problems)
    config = Config.model_validate(_nested(values))
    return Loaded(config, origins, files.read, files.ignored)


def given_lines(loaded: Loaded) -> list[str]:
    """Return a line for each value that is not a default, with its source."""
    return [
        f"{key} = {toml_value(_value_at(loaded.config, key))}  # {origin}"
        for key, origin in loaded.origins.items()
        if origin != _DEFAULT
    ]


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


def _from_environment(
    environment: Mapping[str, str], known: Mapping[str, Setting], problems: list[str]
) -> Iterator[Given]:
    by_variable = {_variable(key): key for key in known}
    for variable, value in sorted(environment.items()):
        if variable in by_variable:
            yield Given(by_variable[variable], value, variable)
        elif variable.startswith(PREFIX) and variable not in _OTHER_VARIABLES:
            if is_secret_name(variable):
                problems.append(f"{variable}: {ADVICE}")
                continue
            hint = _hint(variable, [*by_variable, FILE_VARIABLE, FOLDER_VARIABLE])
            problems.append(f"unknown environment variable {variable}{hint}")


def _unknown(key: str, known: Iterable[str]) -> str:
    if is_secret_name(key):
        return f"{key}: {ADVICE}"
    sections = dict.fromkeys(other.partition(".")[0] for other in known)
    return f"unknown setting {key}{_hint(key, [*known, *sections])}"


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
