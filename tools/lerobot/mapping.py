# SPDX-License-Identifier: Apache-2.0
"""The mapping: a TOML file that says which topics and fields become which columns."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from gateway.codec.error_text import hint
from gateway.errors import system_reason
from schemas.backports import tomllib
from tools.lerobot.errors import ConversionError

Seconds = Annotated[float, Field(gt=0, le=3600)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Numbers(_Table):
    """Fields of one topic, by the names that they get in the dataset."""

    topic: str
    fields: dict[str, str] = Field(min_length=1)
    max_age_s: Seconds | None = None
    default: float | None = None


class Images(_Table):
    """A camera, and the name that it gets in the dataset."""

    topic: str
    name: str = Field(pattern=r"^[A-Za-z0-9_]+$")  # of a directory
    max_age_s: Seconds | None = None

    @property
    def key(self) -> str:
        """The name of its feature."""
        return f"observation.images.{self.name}"


class Mapping(_Table):
    """All of the file. docs/how-to/train.md explains the keys."""

    fps: int = Field(ge=1, le=240)
    robot_type: str | None = None
    task: str = ""
    episodes: Literal["labelled", "successful", "all"] = "labelled"
    max_age_s: Seconds = 0.5
    state: list[Numbers] = Field(min_length=1)
    action: list[Numbers] = Field(min_length=1)
    image: list[Images] = []

    @property
    def topics(self) -> set[str]:
        """All topics that it names."""
        numbers = {each.topic for each in (*self.state, *self.action)}
        return numbers | {each.topic for each in self.image}


def read_mapping(path: Path) -> Mapping:
    """Read a mapping.

    Raises:
        ConversionError: the file cannot be read, or something in it is wrong.
    """
    try:
        mapping = Mapping.model_validate(tomllib.loads(path.read_text("utf-8")))
    except OSError as error:
        raise ConversionError(
            f"cannot read {path}, {system_reason(error)}: name a mapping that you can read"
        ) from error
    except ValidationError as error:
        raise ConversionError(
            "\n".join(f"{path}: {_problem(each)}" for each in error.errors())
        ) from error
    except ValueError as error:  # TOML, or the encoding of the text
        raise ConversionError(f"{path} is not TOML, {error}: correct it") from error
    for key, names in (
        ("state", names_of(mapping.state)),
        ("action", names_of(mapping.action)),
        ("image", [each.name for each in mapping.image]),
    ):
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise ConversionError(f"{path}: {key} has two columns {twice[0]}: rename one of them")
    return mapping


def names_of(tables: Iterable[Numbers]) -> list[str]:
    """Return the names of the numbers, in order."""
    return [name for table in tables for name in table.fields]


def _problem(error: Any) -> str:
    """Return a sentence about one mistake, which pydantic found."""
    *parents, last = error["loc"]
    place = ".".join(map(str, error["loc"]))
    if error["type"] == "missing":
        return f"{place} is missing: add it"
    if error["type"] == "extra_forbidden":
        table: type[_Table] = Mapping
        if parents:
            table = Images if parents[0] == "image" else Numbers
        return f"unknown key {place}{hint(str(last), table.model_fields)}"
    reason: str = error["msg"]
    return f"{place} is {error['input']!r}: {reason[0].lower()}{reason[1:]}"
