# SPDX-License-Identifier: Apache-2.0
"""Use made types while another thread creates and destroys entities in the same context.

Run it as a program: where Python passes the GIL to the other thread under a lock of DDS, the whole
process hangs. Its one argument says what is done in the meantime.
"""

import faulthandler
import itertools
import sys
import threading

from rclpy.context import Context
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_msgs.msg import String
from std_srvs.srv import SetBool

from gateway.sources.rclpy.errors import creation
from gateway.sources.rclpy.made_types.classes import MadeTypes
from gateway.sources.rclpy.rclpy_private.handles import request_sender
from gateway.sources.rclpy.service_forms import of_made
from schemas.installed import InstalledDefinitions

SERVICE = "std_srvs/srv/SetBool"
HUNG_S = 120
SENT = 20_000
CREATED = 200
AT_ONCE_S = 1e-6  # any thread that wants the GIL gets it at the next chance


def send(node: Node, made: type, definitions: InstalledDefinitions) -> None:
    """Send requests."""
    request = of_made(SERVICE, made).to_request(serialize_message(SetBool.Request(data=True)))
    sender = request_sender(node.create_client(made, "/arm"))
    for _ in range(SENT):
        sender(request)


def create(node: Node, made: type, definitions: InstalledDefinitions) -> None:
    """Create clients, services, publishers and subscriptions."""
    header = definitions.get("std_msgs/msg/Header")
    for _ in range(CREATED):
        message = MadeTypes().get(header, definitions)  # another one each time
        with creation("/header"):
            node.destroy_publisher(node.create_publisher(message, "/header", 10))
            node.destroy_subscription(node.create_subscription(message, "/header", nothing, 10))
        with creation("/reset"):
            node.destroy_client(node.create_client(made, "/reset"))
            node.destroy_service(node.create_service(made, "/reset", nothing))


def main(what: str) -> None:
    """Do it, or hang."""
    faulthandler.dump_traceback_later(HUNG_S, exit=True)
    context = Context()
    context.init(args=[])
    node, other = (
        Node(name, context=context, start_parameter_services=False) for name in ("node", "other")
    )
    definitions = InstalledDefinitions()
    made = MadeTypes().service(definitions.interface(SERVICE), definitions)
    is_over = threading.Event()
    created = itertools.count()

    def create_beside() -> None:
        while not is_over.is_set():
            other.destroy_subscription(other.create_subscription(String, "/text", nothing, 10))
            next(created)

    beside = threading.Thread(target=create_beside)
    sys.setswitchinterval(AT_ONCE_S)
    beside.start()
    {"send": send, "create": create}[what](node, made, definitions)
    is_over.set()
    beside.join()
    context.shutdown()
    print("created beside", next(created))  # noqa: T201


def nothing(*_: object) -> None:
    """Do nothing with a message."""


if __name__ == "__main__":
    main(*sys.argv[1:])
