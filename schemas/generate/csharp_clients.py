# SPDX-License-Identifier: Apache-2.0
"""C# for clients: the classes of some types, in the form of the Unity package's own messages."""

from schemas.build import checked_in_hash
from schemas.definition import Definition
from schemas.generate.catalogue import Catalogue, by_package
from schemas.generate.csharp_messages import file_of, namespace_of
from schemas.generate.csharp_text import head, namespace
from schemas.generate.request import ClientCodeError, Request


def files(request: Request) -> dict[str, str]:
    """Return a file for each package.

    Raises:
        ClientCodeError: two packages have the same name space, or no class is left to write.
    """
    return {
        f"{namespace(package)}.cs": file_of([text], head(request.generated))
        for package, text in _namespaces(request).items()
    }


def text(request: Request) -> str:
    """Return all classes in one text.

    Raises:
        ClientCodeError: two packages have the same name space, or no class is left to write.
    """
    return file_of(_namespaces(request).values(), head(request.generated))


def differing(catalogue: Catalogue) -> list[str]:
    """Return the types whose classes in the Unity package have other fields, sorted."""
    known = {one.name: checked_in_hash(one.name) for one in catalogue.messages()}
    return sorted(name for name, own in known.items() if own not in {None, catalogue.hashes[name]})


def _namespaces(request: Request) -> dict[str, str]:
    purposes = request.catalogue.purposes()
    wanted = request.catalogue.messages()
    if not request.complete:
        # a second class of the same name would collide with that of the package
        wanted = [one for one in wanted if checked_in_hash(one.name) is None]
    if not wanted:
        names = ", ".join(request.names)
        raise ClientCodeError(
            f"the Unity package has all classes of {names}: use those, "
            "or add --complete to have them written for a program without the package's own"
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
