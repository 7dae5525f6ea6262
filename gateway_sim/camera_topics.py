# SPDX-License-Identifier: Apache-2.0
"""The simulated camera's topics: the picture raw and as JPEG, and the calibration."""

from typing import Final

import cv2
from rclpy.node import Node
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from gateway_sim import robot_messages
from gateway_sim.camera import Camera
from gateway_sim.world import Pose, World

_DEPTH: Final = 3  # pictures kept for a slow reader: 0.1 s, 2.8 MB (older ones only delay)
# of 100: sharp at 30 KB a picture
_JPEG_PARAMETERS: Final = (cv2.IMWRITE_JPEG_QUALITY, 85)


class CameraTopics:
    """Publishes images with image_transport's topic names, and draws them only for subscribers."""

    def __init__(self, node: Node, world: World) -> None:
        self._camera = Camera(world)
        self._image = node.create_publisher(Image, "camera/image_raw", _DEPTH)
        self._jpeg = node.create_publisher(CompressedImage, "camera/image_raw/compressed", _DEPTH)
        self._info = node.create_publisher(CameraInfo, "camera/camera_info", _DEPTH)

    def publish(self, header: Header, pose: Pose) -> None:
        """Publish the view of a robot at *pose* to the subscribers."""
        robot_messages.offer(self._info, lambda: robot_messages.camera_info(header))
        wants_image = self._image.get_subscription_count() > 0
        wants_jpeg = self._jpeg.get_subscription_count() > 0
        if not (wants_image or wants_jpeg):
            return
        picture = self._camera.draw(pose)
        if wants_image:
            self._image.publish(robot_messages.image(header, picture))
        if wants_jpeg:
            blue_first = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
            _, jpeg = cv2.imencode(".jpg", blue_first, _JPEG_PARAMETERS)
            self._jpeg.publish(robot_messages.compressed_image(header, jpeg))
