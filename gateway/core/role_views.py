# SPDX-License-Identifier: Apache-2.0
"""Rosapi and parameters as the clients of each role see them."""

from dataclasses import dataclass
from functools import partial

from gateway.access.permissions import Permissions
from gateway.codec.types import Types
from gateway.config.access import AnyRole
from gateway.core.introspection.parameter_operations import ParameterOperations
from gateway.core.permission_checks import check_call
from gateway.core.rosapi import Parameters, Rosapi
from gateway.core.service_clients import ServiceClients
from gateway.core.session import Session
from gateway.core.visible_graph import VisibleGraph
from gateway.sources.source import Ros


@dataclass(frozen=True, slots=True)
class RoleView:
    """The parts of the router that answer differently for each role."""

    rosapi: Rosapi
    parameters: ParameterOperations


class RoleViews:
    """Makes a view for each role that has bounds, and one for everybody else."""

    def __init__(self, ros: Ros, types: Types, service_clients: ServiceClients) -> None:
        self._ros = ros
        self._types = types
        self._service_clients = service_clients
        parameters = Parameters(ros, types, service_clients)
        rosapi = Rosapi(ros, types.definitions, parameters)
        self.unlimited = RoleView(rosapi, ParameterOperations(parameters))
        self._by_role: dict[AnyRole, tuple[Permissions, RoleView]] = {}

    def of(self, session: Session) -> RoleView:
        """Return the view of a client."""
        if not session.is_restricted or session.identity is None:
            return self.unlimited
        permissions = session.identity.permissions
        known = self._by_role.get(permissions.role)
        if known is None or known[0] is not permissions:  # they were reloaded
            known = self._by_role[permissions.role] = permissions, self._make(permissions)
        return known[1]

    def _make(self, permissions: Permissions) -> RoleView:
        graph = VisibleGraph(self._ros, permissions.sees)
        check = partial(check_call, permissions)
        parameters = Parameters(graph, self._types, self._service_clients, check)
        rosapi = Rosapi(graph, self._types.definitions, parameters, permissions.sees)
        return RoleView(rosapi, ParameterOperations(parameters))
