# SPDX-License-Identifier: Apache-2.0
"""The names of ROS types, packages, fields and constants in Python."""

import keyword
from typing import Final

# Public attributes of pydantic.BaseModel. Listed here, so that generated code does not depend on
# the installed pydantic. Names that begin with "model_" have a separate rule.
_BASE_MODEL: Final = frozenset(
    {
        "construct",
        "copy",
        "dict",
        "from_orm",
        "json",
        "parse_file",
        "parse_obj",
        "parse_raw",
        "schema",
        "schema_json",
        "update_forward_refs",
        "validate",
    }
)
# Names that the bodies of generated classes use: a field of that name would hide them from
# the lines below it.
_OF_GENERATED_CLASSES: Final = frozenset(
    {"bool", "bytes", "float", "int", "list", "ros", "ros_type", "ros_type_hash", "str"}
)
_TAKEN: Final = frozenset(keyword.kwlist) | _BASE_MODEL | _OF_GENERATED_CLASSES


def class_name(short_name: str) -> str:
    """Return the class of a message type: mostly its own name.

    Python has the capitalized keywords ``None``, ``True`` and ``False``. These get an underscore.
    """
    return f"{short_name}_" if keyword.iskeyword(short_name) else short_name


def module_name(package: str) -> str:
    """Return the module of a package: mostly its own name. Keywords get an underscore."""
    return f"{package}_" if keyword.iskeyword(package) else package


def attribute(field_name: str) -> str:
    """Return the Python attribute for a field of a message: mostly its own name.

    A trailing underscore is added if the name is taken: by Python (``from``), by the base
    class (``copy``, ``model_...``), or by classes and constants, which begin with a capital.
    Different fields always get different attributes.
    """
    bare = field_name.rstrip("_")  # "from_" must make room for a "from"
    if bare in _TAKEN or bare.startswith("model_") or field_name[0].isupper():
        return f"{field_name}_"
    return field_name


def constant_attribute(constant_name: str) -> str:
    """Return the Python attribute for a constant of a message."""
    bare = constant_name.rstrip("_")
    if bare in _TAKEN or bare.startswith("model_"):
        return f"{constant_name}_"
    return constant_name
