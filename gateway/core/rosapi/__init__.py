# SPDX-License-Identifier: Apache-2.0
"""The rosapi services of rosbridge, answered in-process: the graph, types, parameters, time.

The map is docs/contributing/architecture.md.
"""

from gateway.core.rosapi.interfaces import interfaces_prefix
from gateway.core.rosapi.node_parameters import Parameters, SetResult
from gateway.core.rosapi.service_table import Rosapi

__all__ = ["Parameters", "Rosapi", "SetResult", "interfaces_prefix"]
