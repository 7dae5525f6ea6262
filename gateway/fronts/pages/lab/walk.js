// SPDX-License-Identifier: Apache-2.0
// The viewer without a headset: WASD walk, dragging looks around, Home goes back, a click or Enter points at the floor.

import { Group, PerspectiveCamera, Raycaster, Vector2, Vector3 } from "../vendor/three.js";
import { isTaken, watchKeys, whenUnseen } from "../shared/keys.js";
import { whenHeld } from "../shared/stop_held.js";
import { Bounds } from "./bounds.js";

const EYES_M = 1.6;
const WALK_M_S = 2;
const TURN_RAD_S = 1.5;
const LOOK_RAD_PX = 0.004;
const CLICK_PX = 5; // a longer move of the mouse looks around
const STEEPEST = 1.5; // radians
const LONGEST_S = 0.1; // of a frame: after a pause nobody wants to find himself elsewhere
const WALKING = { KeyW: [1, 0], KeyS: [-1, 0], KeyA: [0, -1], KeyD: [0, 1] };
const TURNING = { KeyQ: [1, 0], KeyE: [-1, 0] };

/** A rig that stands on the floor, and the camera in it. */
export class Viewer {
  rig = new Group();
  /** Whether a headset shows the room: nobody in it is turned by a mouse, nor walks by keys. */
  isWorn = false;
  camera = new PerspectiveCamera(65, 1, 0.05, 50);
  bounds = new Bounds();
  #before = new Vector3(); // a step
  #walking = { ahead: 0, right: 0, turn: 0 };
  #raycaster = new Raycaster();
  #pointer = new Vector2();
  #drag = null;

  constructor() {
    this.rig.add(this.camera);
    this.goHome();
  }

  /** Stand where one stands at first, and look straight ahead from the eyes' height: also after a headset. */
  goHome() {
    this.rig.position.set(0, 0, 3.2); // behind the robot, which starts in the middle and looks ahead. Far enough to see the screens whole
    this.rig.rotation.set(0, 0, 0);
    this.camera.position.set(0, EYES_M, 0);
    this.camera.rotation.set(-0.27, 0, 0); // the middle of the view is on the floor, before the wall of most rooms
    this.camera.scale.set(1, 1, 1);
  }

  /** Listen to keys and mouse. *Point* gets a raycaster along what was clicked. */
  listen(canvas, point) {
    watchKeys(WALKING, (ahead, right) => Object.assign(this.#walking, { ahead, right }));
    watchKeys(TURNING, (turn) => (this.#walking.turn = turn));
    addEventListener("keydown", (event) => event.code === "Home" && !isTaken(event) && !this.isWorn && this.goHome());
    canvas.addEventListener("pointerdown", (event) => {
      if (!event.isPrimary || event.button || this.isWorn) return;
      canvas.setPointerCapture(event.pointerId);
      this.#drag = { x: event.clientX, y: event.clientY, isLook: false };
    });
    canvas.addEventListener("pointermove", (event) => event.isPrimary && this.#look(event));
    canvas.addEventListener("pointerup", (event) => {
      if (!this.#drag || !event.isPrimary) return;
      if (!this.#drag.isLook && !this.isWorn) {
        const { left, top, width, height } = canvas.getBoundingClientRect();
        point(this.#ray((2 * (event.clientX - left)) / width - 1, 1 - (2 * (event.clientY - top)) / height));
      }
      this.#drag = null;
    });
    const drop = () => (this.#drag = null);
    canvas.addEventListener("pointercancel", drop);
    whenHeld(drop); // its end would send the robot after STOP
    whenUnseen(drop, { where: canvas, signal: undefined });
    canvas.addEventListener("keydown", (event) => event.code === "Enter" && !event.repeat && !this.isWorn && point(this.#ray(0, 0)));
  }

  /** Walk for as long as a frame took. */
  step(seconds) {
    const { ahead, right, turn } = this.#walking;
    if (this.isWorn || (!ahead && !right && !turn)) return;
    const taken = Math.min(seconds, LONGEST_S);
    this.rig.rotation.y += turn * TURN_RAD_S * taken;
    this.#before.copy(this.rig.position);
    const heading = this.rig.rotation.y;
    const metres = (WALK_M_S * taken) / Math.max(1, Math.hypot(ahead, right));
    this.rig.position.x += metres * (right * Math.cos(heading) - ahead * Math.sin(heading));
    this.rig.position.z -= metres * (right * Math.sin(heading) + ahead * Math.cos(heading));
    this.bounds.keepStep(this.rig.position, this.#before);
  }

  #look(event) {
    if (!this.#drag || this.isWorn) return;
    const [right, down] = [event.clientX - this.#drag.x, event.clientY - this.#drag.y];
    if (!this.#drag.isLook && Math.hypot(right, down) < CLICK_PX) return;
    this.#drag = { x: event.clientX, y: event.clientY, isLook: true };
    this.rig.rotation.y += right * LOOK_RAD_PX;
    this.camera.rotation.x = Math.max(-STEEPEST, Math.min(STEEPEST, this.camera.rotation.x + down * LOOK_RAD_PX));
  }

  #ray(right, up) {
    this.camera.updateWorldMatrix(true, false);
    this.#raycaster.setFromCamera(this.#pointer.set(right, up), this.camera);
    return this.#raycaster;
  }
}
