# SPDX-License-Identifier: Apache-2.0
"""Services: call one, or provide one."""

from typing import Any

from gateway.codec.nonfinite import NonFinite
from gateway.core import requests
from gateway.fronts.rosbridge.operations.base import FragmentSize, Operation, Seconds


class CallService(Operation):
    """Call a service. The answer is a `service_response` with the same id, whatever happens."""

    op = "call_service"
    makes = requests.CallService
    service: str
    args: Any = None  # an object, or the values of the fields in order
    type: str | None = None
    nonfinite: NonFinite = "null"
    timeout: Seconds | None = None
    fragment_size: FragmentSize = None

    def request(self) -> requests.CallService:
        """Return it for the core."""
        return requests.CallService(
            id=self.id,
            service=self.service,
            args=self.args,
            type=self.type,
            timeout=self.timeout,
            form=self,
        )


class AdvertiseService(Operation):
    """Provide a service: calls come as `call_service`, answers go back as `service_response`."""

    op = "advertise_service"
    makes = requests.AdvertiseService
    service: str
    type: str


class UnadvertiseService(Operation):
    """Stop providing a service."""

    op = "unadvertise_service"
    makes = requests.UnadvertiseService
    service: str


class ServiceResponse(Operation):
    """Answer a call that the gateway passed on. *id* is the call's."""

    op = "service_response"
    makes = requests.ServiceResponse
    service: str
    values: Any = None
    result: bool = True
