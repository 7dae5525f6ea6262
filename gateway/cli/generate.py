# SPDX-License-Identifier: Apache-2.0
"""``ros2-gateway generate``: from arguments to texts in a language, and to files."""

import argparse
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Final

from gateway.cli.remote_connection import gateway_of, is_for_access
from gateway.cli.remote_types import remote_types
from gateway.cli.type_names import TypeNames, is_pattern, local_definitions, matching
from gateway.errors import GatewayError, UsageError, system_reason
from schemas.definition import DefinitionError
from schemas.generate.catalogue import Catalogue
from schemas.generate.languages import LANGUAGES
from schemas.generate.request import MARK, ClientCodeError, GenerateRequest
from schemas.installed import InstalledDefinitions, UnknownTypeError

_HEAD_BYTES: Final = 512  # the mark of generated files is in their first lines
_WHERE_ELSE: Final = """\
install its package, name a folder with its definition by --types-path, or a running gateway \
by --from"""


@dataclass(frozen=True, slots=True)
class Generated:
    """The text for standard output, and notes for people."""

    text: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Found:
    """Definitions, the full names of what was asked for, and each as it was asked for."""

    definitions: InstalledDefinitions
    names: tuple[str, ...]
    shown: tuple[str, ...]


def generate(arguments: argparse.Namespace, environment: Mapping[str, str]) -> Generated:
    """Write the files that *arguments* ask for, or return the text.

    Raises:
        UsageError: a type is unknown, its definition is wrong, or files of others are in the way.
        ConfigError: a folder of definitions, or the configuration that names it, is wrong.
        GatewayError: a running gateway cannot be asked, or a file not be written.
    """
    _check(arguments)
    try:
        with _found(arguments, environment) as found:
            request = _request(arguments, found)
        return _generated(arguments, request)
    except (DefinitionError, ClientCodeError) as error:
        raise UsageError(str(error)) from error


def _check(arguments: argparse.Namespace) -> None:
    if arguments.wire != "json" and arguments.language != "typescript":
        raise UsageError("--wire works only with typescript")
    if arguments.complete and arguments.language != "csharp":
        raise UsageError("--complete works only with csharp")
    if arguments.asmdef and (arguments.language != "csharp" or arguments.output is None):
        raise UsageError(
            "--asmdef works only with csharp and --output: it is a file next to the classes"
        )
    if arguments.source is None and is_for_access(arguments):
        raise UsageError(
            "--token-file, --ca and --timeout are for a running gateway: name it by --from"
        )
    if arguments.source is not None and (arguments.types_path or arguments.config):
        raise UsageError("--from asks a gateway: leave out --types-path and --config, or --from")


@contextmanager
def _found(arguments: argparse.Namespace, environment: Mapping[str, str]) -> Iterator[_Found]:
    if arguments.source is None:
        yield _local(arguments, environment)
        return
    with remote_types(gateway_of(arguments, environment), arguments.types) as (definitions, named):
        names = {name for each in named.values() for name in each}
        shown = {
            name
            for requested, each in named.items()
            for name in ([requested] if is_pattern(requested) else each)
        }
        yield _Found(definitions, tuple(sorted(names)), tuple(sorted(shown)))


def _local(arguments: argparse.Namespace, environment: Mapping[str, str]) -> _Found:
    definitions = local_definitions(arguments, environment)
    known = TypeNames(definitions)
    names: set[str] = set()
    shown: set[str] = set()
    for requested in arguments.types:
        if is_pattern(requested):
            names.update(matching(requested, definitions.all_names()))
            shown.add(requested)
            continue
        if requested.startswith("/"):
            text = f"{requested} is a name, not a type: a gateway knows its type, named by --from"
            raise UsageError(text)
        name = known.resolve(requested)
        try:
            definitions.get_any(name)
        except UnknownTypeError as error:
            near = known.nearest(name)
            hint = f", did you mean {near}? If not, {_WHERE_ELSE}" if near else f": {_WHERE_ELSE}"
            raise UsageError(f"{error}{hint}") from error
        names.add(name)
        shown.add(name)
    return _Found(definitions, tuple(sorted(names)), tuple(sorted(shown)))


def _request(arguments: argparse.Namespace, found: _Found) -> GenerateRequest:
    try:
        catalogue = Catalogue.of_types(found.names, found.definitions)
    except UnknownTypeError as error:  # a nested one
        raise UsageError(f"{error}: {_WHERE_ELSE}") from error
    asked = GenerateRequest(
        found.names, catalogue, MARK, arguments.wire, arguments.complete, arguments.asmdef
    )
    return asked.made_by(arguments.language, found.shown)


def _generated(arguments: argparse.Namespace, request: GenerateRequest) -> Generated:
    language = LANGUAGES[arguments.language]
    notes = language.notes(request)
    if arguments.output is None:
        return Generated(language.text(request), notes)
    texts = language.files(request)
    if request.asmdef is not None:
        _check_assembly(arguments.output, request.asmdef)
    if arguments.language == "csharp":
        notes = (*notes, *_notes_of_old(arguments.output, texts))
    changed = write_files(
        arguments.output,
        texts,
        MARK,
        replace=arguments.force,
        optional=language.optional,
    )
    lines = [f"wrote {path}\n" for path in changed] or ["nothing has changed\n"]
    return Generated("".join(lines), notes)


def _check_assembly(folder: Path, name: str) -> None:
    """Refuse a second assembly definition: Unity takes one in a folder."""
    other = next((p.name for p in folder.glob("*.asmdef") if p.name != f"{name}.asmdef"), None)
    if other is not None:
        raise UsageError(
            f"{folder} has {other}, and Unity allows one assembly in a folder: name that one, or "
            "choose another --output"
        )


def _notes_of_old(folder: Path, texts: Mapping[str, str]) -> Iterator[str]:
    """Warn of classes of an earlier run: with an assembly, only the last run registers its own."""
    old = [p.name for p in made_files(folder, "*.cs", MARK) if p.name not in texts]
    if old and "MessageRegistration.cs" in {*old, *texts}:
        yield (
            f"{', '.join(old)} in {folder} {'is' if len(old) == 1 else 'are'} of an earlier run: "
            "name all types at once and --asmdef, or delete what is no longer wanted"
        )


def write_files(
    folder: Path,
    texts: Mapping[str, str],
    mark: str,
    *,
    replace: bool = False,
    optional: Collection[str] = (),
) -> list[Path]:
    """Write texts by their paths below a folder, and return the paths of the files that changed.

    A file without *mark* in its first lines is foreign. If there is one, nothing is written, unless
    *replace* is set. A foreign file whose name fits one of the patterns *optional* stays as it is.

    Raises:
        UsageError: files would be overwritten, or something else is in their place.
        GatewayError: a file cannot be read or written.
    """
    wanted = {folder / path: text.encode() for path, text in texts.items()}
    try:
        foreign = [path for path in wanted if _is_foreign(path, mark) and not replace]
        kept = {p for p in foreign if any(fnmatch(p.name, pattern) for pattern in optional)}
        if refused := [path for path in foreign if path not in kept]:
            more = f" and {len(refused) - 1} more" if len(refused) > 1 else ""
            raise UsageError(
                f"{refused[0]}{more} would be overwritten, and this command has not made it: "
                "choose another --output, or add --force"
            )
        changed = [
            path
            for path, content in wanted.items()
            if path not in kept and not (path.is_file() and path.read_bytes() == content)
        ]
        for path in changed:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(wanted[path])
    except OSError as error:
        raise GatewayError(f"cannot write {error.filename}, {system_reason(error)}") from error
    return changed


def made_files(folder: Path, pattern: str, mark: str) -> list[Path]:
    """Return the files of a folder that have *mark*, and none if the folder is missing.

    Raises:
        GatewayError: a file cannot be read.
    """
    try:
        return [p for p in sorted(folder.glob(pattern)) if p.is_file() and not _is_foreign(p, mark)]
    except OSError as error:
        raise GatewayError(f"cannot read {error.filename}, {system_reason(error)}") from error


def _is_foreign(path: Path, mark: str) -> bool:
    if not path.exists():
        return False
    if not path.is_file():  # a pipe would be waited for, a folder cannot be replaced either
        raise UsageError(f"{path} is not a file: choose another --output")
    with path.open("rb") as file:
        return mark.encode() not in file.read(_HEAD_BYTES)
