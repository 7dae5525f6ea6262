# SPDX-License-Identifier: Apache-2.0
"""TypeScript for clients such as roslibjs: interfaces of the messages as they are received.

A package is a module or, in one text of all, a name space. Both refer to others as
``std_msgs.Header``. The parts of services and actions have rosidl's names (``SetBool_Request``):
no message has an underscore in its name.
"""

from collections.abc import Iterable, Mapping
from typing import Final

from schemas.definition import Constant, Definition, Field
from schemas.generate.catalogue import by_package
from schemas.generate.request import GenerateRequest, Wire
from schemas.generate.typescript_text import documentation, identifier, literal, remark, type_of

_ABOUT: Final[Mapping[Wire, str]] = {
    "json": "Messages as JSON: octets are base64, NaN and infinities null.",
    "cbor": 'Messages of subscriptions with compression "cbor", as roslib 2 reads them.',
}


def files(request: GenerateRequest) -> dict[str, str]:
    """Return a module for each package."""
    return {
        f"{identifier(package)}.ts": "\n".join(
            [_top(request), *_imports(own), *_body(request, own)]
        )
        for package, own in by_package(request.catalogue.messages()).items()
    }


def text(request: GenerateRequest) -> str:
    """Return one module with a name space for each package."""
    lines = [_top(request)]
    for package, own in by_package(request.catalogue.messages()).items():
        inner = [f"  {line}" if line else line for line in _body(request, own)[:-1]]
        lines += [f"export namespace {identifier(package)} {{", *inner, "}", ""]
    return "\n".join(lines)


def _top(request: GenerateRequest) -> str:
    return f"// {request.generated}\n// {_ABOUT[request.wire]}\n/* eslint-disable */\n"


def _imports(definitions: Iterable[Definition]) -> list[str]:
    own = list(definitions)
    packages = {nested.split("/")[0] for one in own for nested in one.nested()}
    names = sorted(identifier(each) for each in packages - {one.package for one in own})
    lines = [f'import type * as {name} from "./{name}.js";' for name in names]
    return [*lines, ""] if lines else []


def _body(request: GenerateRequest, definitions: Iterable[Definition]) -> list[str]:
    purposes = request.catalogue.purposes()
    lines: list[str] = []
    for one in definitions:
        lines += [*_interface(one, request.wire, purposes.get(one.name)), ""]
        if one.constants:
            lines += [*_constants(one), ""]
    return lines


def _interface(definition: Definition, wire: Wire, purpose: str | None) -> list[str]:
    words = f"{purpose}." if purpose else f"`{definition.name}`"
    parts = [words, definition.comment] if definition.comment else [words]
    fields = [line for field in definition.fields for line in _field(field, definition, wire)]
    # without a field it would be any value, and a package may have a type called Record
    fields = fields or ["[name: string]: never;"]
    inner = [f"  {line}" for line in fields]
    return [
        *documentation("\n\n".join(parts)),
        f"export interface {definition.short_name} {{",
        *inner,
        "}",
    ]


def _field(field: Field, definition: Definition, wire: Wire) -> list[str]:
    reference = None
    if not field.type.is_primitive:
        package, _, short_name = field.type.base.split("/")
        is_own = package == definition.package
        reference = short_name if is_own else f"{identifier(package)}.{short_name}"
    words = remark(field.type, wire)
    comment = f"{field.comment}\n\n{words}" if field.comment else words
    declared = f"{field.name}: {type_of(field.type, wire, reference)};"
    return [*documentation(comment), declared]


def _constants(definition: Definition) -> list[str]:
    lines = [line for constant in definition.constants for line in _constant(constant)]
    inner = [f"  {line}" for line in lines]
    # a value with the name of the type
    head = f"export const {definition.short_name} = {{"
    words = f"The constants of `{definition.name}`."
    return [*documentation(words), head, *inner, "} as const;"]


def _constant(constant: Constant) -> list[str]:
    comment = documentation(constant.comment) if constant.comment else []
    return [*comment, f"{constant.name}: {literal(constant.type, constant.value)},"]
