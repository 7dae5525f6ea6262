# SPDX-License-Identifier: Apache-2.0
"""Services as rclpy takes them: a class, and the ways from CDR to its messages and back."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from gateway.sources.rclpy.made_types.raw_messages import RawMessage


@dataclass(frozen=True, slots=True)
class ServiceForm:
    """A service type.

    Bytes that are not CDR of the type raise one of `gateway.sources.rclpy.errors.REFUSALS`. A made
    class notices only an encapsulation that cannot be sent.
    """

    type_name: str  # pkg/srv/Name
    service_class: Any
    to_request: Callable[[bytes], Any]
    to_response: Callable[[bytes], Any]
    to_cdr: Callable[[Any], bytes]


def of_package(type_name: str, service_class: Any) -> ServiceForm:
    """Return the form of a class that a package has."""
    return ServiceForm(
        type_name,
        service_class,
        lambda cdr: deserialize_message(cdr, service_class.Request),
        lambda cdr: deserialize_message(cdr, service_class.Response),
        serialize_message,
    )


def of_made(type_name: str, service_class: Any) -> ServiceForm:
    """Return the form of a class of `gateway.sources.rclpy.made_types`."""
    return ServiceForm(
        type_name, service_class, service_class.Request, service_class.Response, _cdr_of
    )


def _cdr_of(message: RawMessage) -> bytes:
    return message.cdr
