# SPDX-License-Identifier: Apache-2.0
"""A publisher in a separate process, which sends any bytes that it is told to.

Arguments: topic, type, reliability. A line of standard input is a word and CDR in hexadecimal:
``once`` publishes it, ``repeat`` does so at 20 Hz until the next line. Each line is answered by
``done``.
"""

import select
import sys

import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy

from gateway.sources.rclpy.interfaces import message_class

PERIOD_S = 0.05


def say(word: str) -> None:
    sys.stdout.write(f"{word}\n")
    sys.stdout.flush()


def main() -> None:
    topic, type_name, reliability = sys.argv[1:]
    rclpy.init()
    node = rclpy.create_node("talker")
    qos = QoSProfile(depth=100, reliability=ReliabilityPolicy[reliability.upper()])
    publisher = node.create_publisher(message_class(type_name), topic, qos)
    repeated = b""
    say("ready")
    while True:
        if select.select([sys.stdin], [], [], PERIOD_S)[0]:
            word, _, text = sys.stdin.readline().partition(" ")
            if not word:
                return
            cdr = bytes.fromhex(text)
            repeated = cdr if word == "repeat" else b""
            if not repeated:
                publisher.publish(cdr)
            say("done")
        if repeated:
            publisher.publish(repeated)


if __name__ == "__main__":
    try:
        main()
    finally:
        rclpy.try_shutdown()
