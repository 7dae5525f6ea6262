# SPDX-License-Identifier: Apache-2.0
"""The rules that make mutants of code: each mutant is one expression or statement replaced."""

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

# Each rule, and what it does.
EVERYWHERE: Final = {
    "bound": "double and halve the number of a constant, or the default of a setting",
    "limit": "exchange `<` and `<=`, or `>` and `>=`, next to a constant",
    "extreme": "exchange `min` and `max`",
    "number": "change a number in a calculation",
    "refusal": "never raise because of a condition",
}
# for code whose mistakes move a robot, or do not stop it
IN_SAFETY: Final = {
    "off_by_one": "exchange `<` and `<=`, or `>` and `>=`, next to anything else",
    "opposite": "exchange `==` and `!=`, `is` and `is not`, or `in` and `not in`",
    "early_end": "never return, continue, or break because of a condition",
    "operand": "leave out one operand of `and` or `or`",
    "negation": "leave out a `not`",
    "flag": "exchange `True` and `False`",
    "call": "leave out a call whose result is not used",
    "sign": "exchange `+` and `-`",
}

_OFF_BY_ONE: Final = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
_OPPOSITES: Final = {
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
    ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
_FRACTION: Final = re.compile(r"\d\.|[^/]/[^/]")


@dataclass(frozen=True, slots=True)
class Mutant:
    """A part of a file, and the text that replaces it. *old* is on one line, without comments."""

    file: str
    where: str  # the function or constant, such as `Lease.claim`
    rule: str
    old: str
    new: str
    start: int  # in bytes, as `end`
    end: int

    @property
    def name(self) -> str:
        """Its name in reports and waivers, which does not depend on the line."""
        return f"{self.file} {self.where}: {self.old} -> {self.new}"

    def broken(self, source: bytes) -> bytes:
        """Return the file's content with the part replaced."""
        return source[: self.start] + self.new.encode() + source[self.end :]


def mutants_of(file: str, source: bytes, rules: Mapping[str, str]) -> Iterator[Mutant]:
    """Yield what *rules* make of a file."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for where, node in _walk(ast.parse(source), ()):
        for rule, part, new in _changes(node):
            if rule in rules:
                start = starts[part.lineno - 1] + part.col_offset
                end = starts[part.end_lineno - 1] + part.end_col_offset
                yield Mutant(file, ".".join(where), rule, ast.unparse(part), new, start, end)


def is_number(value: ast.AST | None) -> bool:
    """Return whether it is a number, or computed of one. A mere name is another's number."""
    match value:
        case ast.Constant(number):
            return type(number) in {int, float}
        case ast.UnaryOp(_, operand):
            return is_number(operand)
        case ast.BinOp(left, _, right):
            return is_number(left) or is_number(right)
        case ast.Call(ast.Name("round" | "int" | "float"), arguments):
            return any(map(is_number, arguments))
        case _:
            return False


def _walk(node: ast.AST, where: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], ast.AST]]:
    """Yield all nodes that change what the code does, each with its function or constant."""
    children = list(ast.iter_child_nodes(node))
    match node:
        case ast.FunctionDef(name) | ast.AsyncFunctionDef(name):
            where = (*where, name)
            children = [*node.args.defaults, *filter(None, node.args.kw_defaults), *node.body]
        case ast.ClassDef(name):
            where, children = (*where, name), node.body
        case ast.AnnAssign(ast.Name(name), _, value) | ast.Assign([ast.Name(name)], value):
            if not where or where[-1].strip("_")[0].isupper():  # not in a function
                where = (*where, name)
            children = [value] if value else []
        case ast.JoinedStr() | ast.Assert():  # Python 3.11 does not know where the parts are
            return
        case ast.Expr(ast.Call(ast.Attribute(ast.Name(name)))) if name.endswith("logger"):
            return
    yield where, node
    for child in children:
        yield from _walk(child, where)


Change = tuple[str, ast.AST, str]  # a rule, the node to replace, and the new text


def _changes(node: ast.AST) -> Iterator[Change]:
    yield from _of_numbers(node)
    yield from _of_conditions(node)
    match node:
        case ast.Call(ast.Name("min" | "max" as name) as function):
            yield "extreme", function, "max" if name == "min" else "min"
        case ast.Constant(bool(value)):
            yield "flag", node, str(not value)
        case ast.Expr(ast.Call() | ast.Await()):
            yield "call", node, "None"


def _of_numbers(node: ast.AST) -> Iterator[Change]:
    match node:
        case (
            ast.AnnAssign(value=ast.Call(ast.Name("Field"), [number, *_]))
            | ast.AnnAssign(value=ast.expr() as number)
        ) if is_number(number):
            yield from (("bound", number, new) for new in _scaled(number))
        case ast.Assign([ast.Name(name)], number) if name.isupper() and is_number(number):
            yield from (("bound", number, new) for new in _scaled(number))
        case ast.BinOp(left, operator, right):
            if any(isinstance(part, ast.Name) for part in ast.walk(node)):
                numbers = (n for n in (left, right) if isinstance(n, ast.Constant) and is_number(n))
                yield from (("number", n, f"({ast.unparse(n)} * 2 + 1)") for n in numbers)
            if isinstance(operator, ast.Add | ast.Sub) and "'" not in ast.unparse(node):
                other = ast.Sub() if isinstance(operator, ast.Add) else ast.Add()
                yield "sign", node, ast.unparse(ast.BinOp(left, other, right))


def _of_conditions(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Compare():
            is_limit = any(isinstance(n, ast.Name) and n.id.isupper() for n in ast.walk(node))
            rule = "limit" if is_limit else "off_by_one"
            yield from ((rule, node, new) for new in _compared(node, _OFF_BY_ONE))
            yield from (("opposite", node, new) for new in _compared(node, _OPPOSITES))
        case ast.If(test, [*_, ast.Raise()], []):
            yield "refusal", test, "False"
        case ast.If(test, [*_, ast.Return() | ast.Continue() | ast.Break()], []):
            yield "early_end", test, "False"
        case ast.BoolOp(operator, values):
            for value in values:
                rest = [other for other in values if other is not value]
                new = ast.BoolOp(operator, rest) if rest[1:] else rest[0]
                yield "operand", node, f"({ast.unparse(new)})"
        case ast.UnaryOp(ast.Not(), value):
            yield "negation", node, f"({ast.unparse(value)})"


def _scaled(number: ast.expr) -> Iterator[str]:
    match number:
        case ast.Constant(0):  # it stays 0
            pass
        case ast.Constant(value):
            yield repr(value * 2)
            yield repr(value // 2 if isinstance(value, int) else value / 2)
        case _:
            text = ast.unparse(number)
            yield f"({text}) * 2"
            yield f"({text}) {'/' if _FRACTION.search(text) else '//'} 2"


def _compared(node: ast.Compare, others: Mapping[type, type]) -> Iterator[str]:
    for index, operator in enumerate(node.ops):
        if other := others.get(type(operator)):
            operators = [*node.ops[:index], other(), *node.ops[index + 1 :]]
            yield ast.unparse(ast.Compare(node.left, operators, node.comparators))
