# SPDX-License-Identifier: Apache-2.0
"""A check that an object has everything that an interface names, before its first use."""

from typing import Protocol

from gateway.errors import ConfigError


def check_interface(option: str, part: object, interface: type) -> None:
    """Check an object of another author, which *option* of the command line has named.

    A method that a class inherits from the Protocol itself does nothing, so it counts as missing.

    Raises:
        ConfigError: something is missing. The text names all of it.
    """
    names = {
        name
        for each in interface.__mro__
        if each is not Protocol and getattr(each, "_is_protocol", False)
        for name in (*vars(each), *vars(each).get("__annotations__", ()))
        if not name.startswith("_")
    }
    own = type(part)
    missing = [
        name
        for name in sorted(names)
        if not hasattr(part, name) or getattr(own, name, None) is getattr(interface, name, part)
    ]
    if missing:
        text = f"--{option}: {name_of(part)} does not have {', '.join(missing)}"
        raise ConfigError(f"{text}: add what {interface.__module__}:{interface.__name__} asks for")


def name_of(part: object) -> str:
    """Return the module and the class of an object, as the command line names them."""
    return f"{type(part).__module__}:{type(part).__name__}"
