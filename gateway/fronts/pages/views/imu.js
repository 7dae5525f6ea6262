// SPDX-License-Identifier: Apache-2.0
import { element, token } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { anglesOf } from "./angles.js";
import { written } from "./numbers.js";
import { Pairs } from "./pairs.js";

const SIZE = 240; // pixels
const MIDDLE = SIZE / 2;
const PER_DEGREE = 2; // pixels of pitch
const MARKS = [-60, -45, -30, -15, 15, 30, 45, 60]; // degrees of pitch
const DEGREES = 180 / Math.PI;

/** The attitude of an IMU as an artificial horizon, with its turn rates and accelerations. */
export class ImuView {
  static title = say("view.imu");
  static types = ["sensor_msgs/msg/Imu"];

  options = { throttle_rate: 50 };
  #canvas;
  #pen;
  #values = new Pairs();

  constructor(card) {
    this.#canvas = element("canvas", { className: "picture", width: SIZE, height: SIZE, role: "img", aria: { label: say("imu.label", { topic: card.topic }) } });
    this.#pen = this.#canvas.getContext("2d");
    this.element = element("div", { className: "beside" }, this.#canvas, this.#values.element);
  }

  show({ orientation, orientation_covariance: covariance, angular_velocity: turns, linear_acceleration: pushes }) {
    const attitude = covariance[0] === -1 ? null : anglesOf(orientation); // -1: it measures none
    this.#canvas.hidden = !attitude;
    if (attitude) this.#draw(attitude);
    const angles = Object.entries(attitude ?? {}).map(([name, angle]) => /** @type {[string, string]} */ ([say(`angle.${name}`), `${(angle * DEGREES).toFixed(1)}°`]));
    this.#values.show([
      ...(angles.length ? angles : [/** @type {[string, string]} */ ([say("imu.orientation"), say("unmeasured")])]),
      [say("imu.turning"), inAll(turns, "rad/s")],
      [say("imu.acceleration"), inAll(pushes, "m/s²")],
    ]);
  }

  #draw({ roll, pitch }) {
    const pen = this.#pen;
    pen.setTransform(1, 0, 0, 1, MIDDLE, MIDDLE);
    pen.clearRect(-MIDDLE, -MIDDLE, SIZE, SIZE);
    pen.save();
    pen.beginPath();
    pen.arc(0, 0, MIDDLE - 2, 0, 2 * Math.PI);
    pen.clip();
    pen.rotate(-roll);
    pen.translate(0, -pitch * DEGREES * PER_DEGREE); // REP 103: a positive pitch is nose down
    pen.fillStyle = token("map-free");
    pen.fillRect(-SIZE, -4 * SIZE, 2 * SIZE, 4 * SIZE);
    pen.fillStyle = token("map-unknown");
    pen.fillRect(-SIZE, 0, 2 * SIZE, 4 * SIZE);
    pen.strokeStyle = token("text");
    pen.beginPath();
    pen.moveTo(-SIZE, 0);
    pen.lineTo(SIZE, 0);
    for (const degrees of MARKS) {
      pen.moveTo(-20, degrees * PER_DEGREE);
      pen.lineTo(20, degrees * PER_DEGREE);
    }
    pen.stroke();
    pen.restore();
    pen.strokeStyle = token("edge"); // the sky may be as light as the card
    pen.beginPath();
    pen.arc(0, 0, MIDDLE - 2, 0, 2 * Math.PI);
    pen.stroke();
    pen.strokeStyle = token("warning"); // the robot, which stays as it is
    pen.lineWidth = 3;
    pen.beginPath();
    for (const side of [-1, 1]) {
      pen.moveTo(side * 60, 0);
      pen.lineTo(side * 20, 0);
      pen.lineTo(0, 8);
    }
    pen.stroke();
  }
}

const inAll = ({ x, y, z }, unit) => `${[x, y, z].map(written).join(", ")} ${unit}`;
