# SPDX-License-Identifier: Apache-2.0
"""The rosapi services of rosbridge, answered in-process: the graph, types, parameters, time.

The map is docs/contributing/architecture.md.
"""

from gateway.rosapi.interfaces import interfaces_prefix
from gateway.rosapi.node_parameters import Parameters, SetResult
from gateway.rosapi.service_table import Rosapi

__all__ = ["Parameters", "Rosapi", "SetResult", "interfaces_prefix"]
