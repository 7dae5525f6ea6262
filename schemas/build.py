# SPDX-License-Identifier: Apache-2.0
"""The model of any message type: the checked-in one if it fits, else one built at run time."""

import importlib
from typing import Any

from typing_extensions import Self

from schemas import message as ros
from schemas.definition import Definition
from schemas.derived import hashed
from schemas.generate.json_schemas import Schema, interface_schema, schema_of
from schemas.generate.python_models import class_names, class_source
from schemas.installed import InstalledDefinitions
from schemas.interface import Interface
from schemas.message import Message
from schemas.type_hash import type_hash


class Models:
    """The models of the types in some definitions, built on first use.

    A checked-in model is used if its type hash is that of the installed definition, so a robot
    whose fields differ from ours gets models of its definitions. REP-2011 hashes neither
    defaults nor constants: if only these differ, ours are used. Not safe across threads.
    """

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions
        self._known: dict[str, type[Message]] = {}

    @classmethod
    def installed(cls) -> Self:
        """Return the models of the definitions installed on this machine."""
        return cls(InstalledDefinitions())

    def get(self, name: str) -> type[Message]:
        """Return the model of ``pkg/msg/Name``, or of a part such as ``pkg/srv/Name_Request``.

        Raises:
            UnknownTypeError: the type, or one that it nests, is not installed.
            DefinitionError: a definition cannot be parsed.
        """
        known = self._known.get(name)
        if known is None:
            # Nested types first, so that each class finds the classes of its fields.
            for definition in self._definitions.closure([name]):
                if definition.name not in self._known:
                    self._known[definition.name] = self._model(definition)
            known = self._known[name]
        return known

    def json_schema(self, name: str) -> Schema:
        """Return the JSON Schema of a message, a service or an action, nested types included.

        Raises:
            UnknownTypeError, DefinitionError: as for `get`.
        """
        definition = self._definitions.get_any(name)
        if isinstance(definition, Interface):
            parts = {role: self.json_schema(part.name) for role, part in definition.parts.items()}
            return interface_schema(hashed(definition, self._definitions), parts)
        nested = self._definitions.closure(definition.nested())
        return schema_of(definition, nested, type_hash(definition, self._definitions))

    def _model(self, definition: Definition) -> type[Message]:
        expected_hash = type_hash(definition, self._definitions)
        return _checked_in(definition, expected_hash) or self._executed(definition, expected_hash)

    def _executed(self, definition: Definition, hash_: str) -> type[Message]:
        names = class_names([definition])
        module = f"schemas.models.{definition.package}"
        namespace: dict[str, Any] = {"__name__": module, "ros": ros}
        namespace |= {names[nested]: self._known[nested] for nested in definition.nested()}
        source = class_source(definition, hash_, names)
        # The parser's patterns or quoting as a literal made every name and text in it safe.
        exec(compile(source, f"<{definition.name}>", "exec"), namespace)  # noqa: S102
        model: type[Message] = namespace[names[definition.name]]
        return model


def json_schema(name: str, definitions: InstalledDefinitions) -> Schema:
    """Return the JSON Schema of one type.

    Raises:
        UnknownTypeError, DefinitionError: as for `Models.json_schema`.
    """
    return Models(definitions).json_schema(name)


def checked_in_hash(name: str) -> str | None:
    """Return the hash of the checked-in model of ``pkg/msg/Name``, or of a part. None if absent."""
    package, _, short_name = name.split("/")
    model = _model_in_tree(package, short_name)
    return model.ros_type_hash if model is not None and model.ros_type == name else None


def _checked_in(definition: Definition, expected_hash: str) -> type[Message] | None:
    model = _model_in_tree(definition.package, definition.short_name)
    # The hash covers the full name, so a class imported from another package never fits.
    return model if model is not None and model.ros_type_hash == expected_hash else None


def _model_in_tree(package: str, short_name: str) -> type[Message] | None:
    module_name = f"schemas.models.{package}"
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name != module_name:
            raise
        return None
    model = getattr(module, short_name, None)
    return model if isinstance(model, type) and issubclass(model, Message) else None
