# SPDX-License-Identifier: Apache-2.0
"""The operations on parameters."""

from dataclasses import asdict
from typing import Any

from gateway.core.requests import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    ParameterRequest,
    SetParameters,
)
from gateway.core.rosapi.node_parameters import Parameters, node_timeout_s


class ParameterOperations:
    """Carries out the operations on parameters. Each returns the members of its answer.

    Each raises `ProtocolError` as `Parameters` does.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters

    async def carry_out(self, request: ParameterRequest) -> dict[str, Any]:
        """Return the members of the answer."""
        match request:
            case ListParameters():
                return await self.list(request)
            case GetParameters():
                return await self.get(request)
            case SetParameters():
                return await self.set(request)
            case DescribeParameters():
                return await self.describe(request)
        raise TypeError(request.kind)

    async def list(self, request: ListParameters) -> dict[str, Any]:
        """List a node's parameters."""
        timeout_s = node_timeout_s(request.timeout)
        names = await self._parameters.list_names(request.node, request.prefixes, timeout_s)
        return {"node": request.node, "names": names}

    async def get(self, request: GetParameters) -> dict[str, Any]:
        """Return values."""
        timeout_s = node_timeout_s(request.timeout)
        values = await self._parameters.get(request.node, request.names, timeout_s)
        return {"node": request.node, "values": values}

    async def set(self, request: SetParameters) -> dict[str, Any]:
        """Set values. Report for each whether the node refused it, and why."""
        timeout_s = node_timeout_s(request.timeout)
        results = await self._parameters.set(request.node, request.values, timeout_s)
        return {
            "node": request.node,
            "results": {name: asdict(result) for name, result in results.items()},
        }

    async def describe(self, request: DescribeParameters) -> dict[str, Any]:
        """Return types, descriptions and limits."""
        timeout_s = node_timeout_s(request.timeout)
        described = await self._parameters.describe(request.node, request.names, timeout_s)
        return {"node": request.node, "parameters": described}
