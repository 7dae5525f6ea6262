# SPDX-License-Identifier: Apache-2.0
"""C# for clients: the classes of some types, in the form of the Unity package's own messages."""

from typing import Final

from schemas.build import checked_in_hash
from schemas.definition import Definition
from schemas.generate.catalogue import Catalogue, by_package
from schemas.generate.csharp_assembly import assembly_definition, registration
from schemas.generate.csharp_messages import file_of, namespace_of
from schemas.generate.csharp_text import head, namespace
from schemas.generate.request import ClientCodeError, GenerateRequest

_SHOWN: Final = 3  # of types in a sentence


def files(request: GenerateRequest) -> dict[str, str]:
    """Return a file for each package, and those that make an assembly of them if one is named.

    Raises:
        ClientCodeError: two packages have the same name space, or no class is left to write.
    """
    top = head(request.generated)
    classes = {
        f"{namespace(package)}.cs": file_of([text], top)
        for package, text in _namespaces(request).items()
    }
    if request.asmdef is None:
        return classes
    names = [definition.name for definition in _wanted(request)]
    return classes | assembly_definition(request.asmdef) | registration(names, top)


def text(request: GenerateRequest) -> str:
    """Return all classes in one text.

    Raises:
        ClientCodeError: two packages have the same name space, or no class is left to write.
    """
    return file_of(_namespaces(request).values(), head(request.generated))


def differing(catalogue: Catalogue) -> list[str]:
    """Return the types whose classes in the Unity package have other fields, sorted."""
    known = {one.name: checked_in_hash(one.name) for one in catalogue.messages()}
    return sorted(name for name, own in known.items() if own not in {None, catalogue.hashes[name]})


def notes(request: GenerateRequest) -> tuple[str, ...]:
    """Return a sentence for each type whose class in the package lacks fields of the definition."""
    found = [] if request.complete else differing(request.catalogue)
    return tuple(
        f"{name} has other fields than the class in the Unity package, which is used: fields that "
        "the class lacks are skipped"
        for name in found
    )


def _wanted(request: GenerateRequest) -> list[Definition]:
    wanted = request.catalogue.messages()
    if request.complete:
        return wanted
    # a second class of the same name would collide with that of the package
    return [one for one in wanted if checked_in_hash(one.name) is None]


def _namespaces(request: GenerateRequest) -> dict[str, str]:
    purposes = request.catalogue.purposes()
    wanted = _wanted(request)
    if not wanted:
        names = ", ".join(request.names[:_SHOWN])
        more = len(request.names) - _SHOWN
        raise ClientCodeError(
            f"the Unity package has all classes of {names}{f' and {more} more' * (more > 0)}: use "
            "those; complete, --complete on the command line, writes them for a program without it"
        )
    packages = by_package(wanted)
    _check_names(packages)
    return {package: namespace_of(package, own, purposes) for package, own in packages.items()}


def _check_names(packages: dict[str, list[Definition]]) -> None:
    taken: dict[str, str] = {}
    for package in packages:
        other = taken.setdefault(namespace(package).lower(), package)
        if other != package:
            raise ClientCodeError(
                f"packages {other} and {package} have the same C# name space, "
                f"{namespace(package)}: generate each into a project of its own"
            )
