# SPDX-License-Identifier: Apache-2.0
"""Parameters of other nodes."""

from typing import Annotated, Any

from pydantic import Field

from gateway.core import requests
from gateway.fronts.rosbridge.operations.base import Operation, Seconds

# More than any node of Navigation 2 has, and its answer still fits a frame.
Names = Annotated[tuple[str, ...], Field(strict=False, max_length=1024)]


class ListParameters(Operation):
    """Ask for the names of a node's parameters, or of those below some prefixes."""

    op = "list_parameters"
    makes = requests.ListParameters
    node: str
    prefixes: Names = ()
    timeout: Seconds | None = None


class GetParameters(Operation):
    """Ask for the named values, or for all values of the node."""

    op = "get_parameters"
    makes = requests.GetParameters
    node: str
    names: Names | None = None
    timeout: Seconds | None = None


class SetParameters(Operation):
    """Set values. ``null`` deletes a parameter."""

    op = "set_parameters"
    makes = requests.SetParameters
    node: str
    values: Annotated[dict[str, Any], Field(min_length=1, max_length=1024)]
    timeout: Seconds | None = None


class DescribeParameters(Operation):
    """Ask for types, ranges and descriptions of the named parameters, or of all."""

    op = "describe_parameters"
    makes = requests.DescribeParameters
    node: str
    names: Names | None = None
    timeout: Seconds | None = None


ParameterOperation = ListParameters | GetParameters | SetParameters | DescribeParameters
