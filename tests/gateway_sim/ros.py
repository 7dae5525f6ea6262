# SPDX-License-Identifier: Apache-2.0
"""Shared parts of the tests of real nodes: a child process for one, and a node that watches."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import rclpy
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions

from gateway_sim.loop import Loop
from tests.sources.nodes import open_node

TIMEOUT_S = 120  # of whatever a test waits for: generous, as the machine may be busy


# A process without these has the wheels' packages alone.
WITHOUT_PACKAGES = frozenset({"PYTHONPATH", "AMENT_PREFIX_PATH"})


@contextmanager
def child(code, number=signal.SIGINT, without=frozenset()):
    """Run Python code in a separate process, which a signal must end with exit code 0.

    It lacks the environment variables *without*.
    """
    inherited = {name: value for name, value in os.environ.items() if name not in without}
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**inherited, "PYTHONUNBUFFERED": "1"},
        start_new_session=True,
    )
    try:
        yield process
        assert process.poll() is None, process.communicate()
        process.send_signal(number)
        _, errors = process.communicate(timeout=TIMEOUT_S)
        assert process.returncode == 0, errors
        assert b"Traceback" not in errors
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
        process.stderr.close()


class Watcher:
    """A node of the test's own. Everything runs while the test waits."""

    def __init__(self, name):
        self._context = rclpy.Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self.node = open_node(name, self._context)
        self._loop = Loop(self._context)
        self._loop.add_node(self.node)
        self.received = {}

    def close(self):
        self._loop.close()
        self.node.destroy_node()
        self._context.try_shutdown()

    def subscribe(self, message_type, topic, qos=None, raw=False):
        """Collect a topic's messages, or their CDR, and return the list that they get into."""
        messages = self.received.setdefault(topic, [])
        self.node.create_subscription(
            message_type, topic, messages.append, qos or QoSProfile(depth=100), raw=raw
        )
        return messages

    def until(self, condition, meanwhile=lambda: None, what="the condition"):
        """Wait for a condition. Call *meanwhile* 20 times a second."""
        deadline = time.monotonic() + TIMEOUT_S
        while not condition():
            assert time.monotonic() < deadline, f"waited in vain for {what}"
            meanwhile()
            slice_end = time.monotonic() + 0.05
            while time.monotonic() < slice_end and not condition():
                self._loop.turn(slice_end - time.monotonic())

    def call(self, service_type, name, request):
        client = self.node.create_client(service_type, name)
        self.until(client.service_is_ready, what=name)
        future = client.call_async(request)
        self.until(future.done, what=f"the response of {name}")
        self.node.destroy_client(client)
        return future.result()
