# SPDX-License-Identifier: Apache-2.0
"""Pydantic models for clients: in the form of `schemas.models`, on the base of `schemas.message`.

They are for programs that have this package installed, which needs no ROS.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Final

from schemas.definition import Definition
from schemas.generate.catalogue import by_package
from schemas.generate.python_models import class_sources, module_of, prefixed
from schemas.generate.request import ClientCodeError, GenerateRequest
from schemas.naming import class_name, module_name

INIT: Final = "__init__.py"
_NEEDS: Final = "They need the Python package ros2-json-gateway, without ROS."


def files(request: GenerateRequest) -> dict[str, str]:
    """Return a module for each package, and the ``__init__`` of the package around them.

    Raises:
        ClientCodeError: packages nest types of each other, whose modules could not be imported.
    """
    packages = by_package(request.catalogue.messages())
    _check_order(packages)
    top = f"# {request.generated}\n"
    modules = {
        f"{module_name(package)}.py": top + module_of(package, own, request.catalogue, ".")
        for package, own in packages.items()
    }
    return {
        INIT: f'{top}"""Models of ROS types, a module for each package. {_NEEDS}"""\n',
        **modules,
    }


def text(request: GenerateRequest) -> str:
    """Return one module with all models, nested ones first."""
    catalogue = request.catalogue
    docstring = f'"""Models of ROS types. {_NEEDS}"""'
    start = f"# {request.generated}\n{docstring}\n\nfrom schemas import message as ros\n"
    own = catalogue.messages()
    return "\n\n".join([start, *class_sources(own, catalogue, _unique_names(own))])


def _check_order(packages: Mapping[str, Iterable[Definition]]) -> None:
    needs = {
        package: {nested.split("/")[0] for one in own for nested in one.nested()} - {package}
        for package, own in packages.items()
    }
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        circle = ", ".join(sorted(set(error.args[1])))
        raise ClientCodeError(
            f"packages {circle} nest types of each other, which Python's modules cannot: "
            "leave out --output, and take the one text"
        ) from error


def _unique_names(definitions: Iterable[Definition]) -> dict[str, str]:
    """Return class names that differ. Types that share theirs have the package before it."""
    own = list(definitions)
    shared = Counter(definition.short_name for definition in own)
    names: dict[str, str] = {}
    taken: set[str] = set()
    for one in own:
        is_alone = shared[one.short_name] == 1
        name = class_name(one.short_name) if is_alone else prefixed(one.name)
        while name in taken:
            name += "_"
        taken.add(name)
        names[one.name] = name
    return names
