// SPDX-License-Identifier: Apache-2.0
// The camera of a scene: orbit, top view, follow, and where a pointer points.

import { OrbitControls, PerspectiveCamera, Raycaster, Vector2, Vector3 } from "../vendor/three.js";

const HOME = [-3, -3, 3.5]; // metres from what it looks at
const BEHIND = [-2.5, 0, 1.8]; // the same for a robot that looks along x
const UP = new Vector3(0, 0, 1);
const TURN = Math.PI / 24; // of an arrow key
const PAN_PX = 40;
const ZOOM = 0.85;
const HIT_M = 0.05; // so near a ray may pass a point
const ARROWS = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** The camera, turned by mouse, fingers and keys. */
export class View3d {
  camera = new PerspectiveCamera(50, 1, 0.02, 2000);
  isTop = false;
  #controls;
  #canvas;
  #raycaster = new Raycaster();
  #pointer = new Vector2();

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {() => void} changed
   */
  constructor(canvas, changed) {
    this.#canvas = canvas;
    this.camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.camera, canvas);
    this.#controls.maxDistance = 1000;
    this.#controls.minDistance = 0.1;
    this.#leaveOthers();
    this.#controls.addEventListener("change", changed);
    this.#raycaster.params.Points.threshold = HIT_M;
    this.home(new Vector3());
  }

  /** The place that it looks at. */
  get target() {
    return this.#controls.target;
  }

  /** Look at a place as at first, or from behind what looks along *yaw* there. */
  home(place, yaw = null) {
    this.target.copy(place);
    this.camera.position.copy(side(yaw)).add(place);
    this.#controls.update();
    this.top(this.isTop, yaw);
  }

  /** Look from above, with y up as on a map or else *yaw*, or from the side again. */
  top(isTop, yaw = null) {
    this.isTop = isTop;
    const distance = this.#controls.getDistance();
    this.#controls.minPolarAngle = 0;
    this.#controls.maxPolarAngle = isTop ? 0 : Math.PI;
    this.#controls.enableRotate = !isTop;
    if (isTop) this.camera.position.set(-0.001, 0, 1).applyAxisAngle(UP, yaw ?? Math.PI / 2).setLength(distance).add(this.target);
    else if (this.#controls.getPolarAngle() < 0.1) this.camera.position.copy(side(yaw)).setLength(distance).add(this.target);
    this.#controls.update();
    this.looksAround(this.#isFree);
  }

  #isFree = true;

  /** Let a mouse button and one finger look around, or leave them to a tool. */
  looksAround(isFree) {
    this.#isFree = isFree;
    const [rotate, pan] = [0, 2]; // of MOUSE in three
    this.#controls.mouseButtons.LEFT = isFree ? (this.isTop ? pan : rotate) : null;
    this.#controls.touches.ONE = isFree ? (this.isTop ? 1 : 0) : null; // of TOUCH: pan, rotate
  }

  /** Move with something that moves, from one place to another, and turn with it. */
  follow(from, to, turn = 0) {
    for (const each of [this.target, this.camera.position]) each.sub(from).applyAxisAngle(UP, turn).add(to);
    this.#controls.update();
  }

  /** Turn around what it looks at, by steps to the left. */
  turn(steps) {
    this.#controls.rotateLeft(steps * TURN);
    this.#controls.update();
  }

  /** Take a key. Return whether it was for this. */
  key({ key, shiftKey = false }) {
    if (key in ARROWS) {
      const [across, along] = ARROWS[key];
      if (shiftKey || this.isTop) this.#controls.pan(across * PAN_PX, along * PAN_PX);
      else {
        this.#controls.rotateLeft(across * TURN);
        this.#controls.rotateUp(along * TURN);
      }
    } else if (key === "+" || key === "=") this.#controls.dollyIn(ZOOM);
    else if (key === "-") this.#controls.dollyOut(ZOOM);
    else return false;
    this.#controls.update();
    return true;
  }

  resize(width, height) {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** Point at a place of the screen, or at the middle. Return the ray, which is used again. */
  ray(event = null) {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    if (event) this.#pointer.set(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    else this.#pointer.set(0, 0);
    this.camera.updateMatrixWorld();
    this.#raycaster.setFromCamera(this.#pointer, this.camera);
    return this.#raycaster;
  }

  /** Return where a pointer meets the floor, or null. */
  floor(event = null) {
    const { origin, direction } = this.ray(event).ray;
    const length = -origin.z / direction.z;
    return length > 0 && Number.isFinite(length) && length < 1e5 ? origin.clone().addScaledVector(direction, length) : null;
  }

  /** Return the nearest place of what is drawn below an object that a pointer meets, or that of the floor, or null. */
  pick(object, event = null) {
    const [hit] = this.ray(event).intersectObject(object, true).filter((each) => isVisible(each.object));
    return hit?.point ?? this.floor(event);
  }

  close() {
    this.#controls.dispose();
  }

  /** Leave pointers to others that hold them: three hears those of the whole page while its pointer is down. */
  #leaveOthers() {
    const controls = this.#controls;
    for (const name of ["_onPointerMove", "_onPointerUp"]) {
      const take = controls[name];
      controls[name] = (event) => controls._pointers.includes(event.pointerId) && take(event);
    }
  }
}

const side = (yaw) => (yaw === null ? new Vector3(...HOME) : new Vector3(...BEHIND).applyAxisAngle(UP, yaw));

function isVisible(object) {
  for (let each = object; each; each = each.parent) if (!each.visible) return false;
  return true;
}
