// SPDX-License-Identifier: Apache-2.0
// The controllers and hands in VR, each with a ray. The shapes are made here, because others are fetched from the network.
// Trigger or pinch: a target. Squeeze, or a pinch of the left hand: stop.
// Stick pushed ahead or pressed, touchpad pressed, or thumb and middle finger closed: teleport, when let go.

import { say } from "../shared/language.js";
import {
  BoxGeometry, BufferGeometry, Line, LineBasicMaterial, Mesh, Raycaster, SphereGeometry, Vector3,
} from "../vendor/three.js";
import { along } from "./floor.js";
import { mark } from "./room.js";

const PUSHED = -0.7; // of a stick, which springs back past
const LET_GO = -0.5;
const RAY_M = 5;
const JOINT_M = 0.008;
const NO_GAMEPAD = { axes: [], buttons: [] };
const CLOSED_M = 0.02; // between the tips of thumb and middle finger: they are closed, and farther than the next they are open
const OPEN_M = 0.04;

/** Both hands, with whatever is in them. */
export class Controllers {
  #hands;
  #sender = null; // the hand that sent the robot last
  #to;

  /**
   * @param {import("../vendor/three.js").WebXRManager} xr
   * @param {import("../vendor/three.js").Object3D} rig which they move with
   * @param {import("./room.js").Room} room
   * @param {{target: (ray: Raycaster) => void, refuse: (why: string) => void, stop: () => void, gone: () => void,
   *   stand: (ray: Raycaster, place: Vector3) => boolean, teleport: (place: Vector3) => void}} to `gone`: what sent the robot is held no more, or nothing that could stop it.
   *   `stand` puts into a place where the user can go, if he can
   */
  constructor(xr, rig, room, to) {
    this.#to = to;
    const shapes = {
      grip: [new BoxGeometry(0.035, 0.035, 0.12), room.material("quiet")],
      joint: [new SphereGeometry(JOINT_M, 8, 6), room.material("quiet")],
      ray: [new BufferGeometry().setFromPoints([new Vector3(), new Vector3(0, 0, -RAY_M)]), room.material("accent", LineBasicMaterial)],
    };
    this.#hands = [0, 1].map((index) => new Hand(xr, index, rig, shapes, room.marker("accent", 0.2), {
      ...to,
      target: (hand, ray) => this.#target(hand, ray),
      gone: (hand) => this.#gone(hand),
    }));
  }

  /** Send the robot, unless one hand holds what stops it. */
  #target(hand, ray) {
    this.#sender = hand;
    if (this.#hands.some((each) => each.isStopping)) this.#to.refuse(say("lab.squeezed"));
    else this.#to.target(ray);
  }

  #gone(hand) {
    if (hand === this.#sender || !this.#hands.some((each) => each.canStop)) this.#to.gone();
  }

  /** Read the buttons and sticks. This allocates nothing. */
  step() {
    for (const hand of this.#hands) hand.step();
  }

  /** Forget what is pushed: for the end of a session, or of its being seen. */
  letGo() {
    for (const hand of this.#hands) hand.letGo();
  }
}

/** One hand. */
class Hand {
  /** Whether it holds what stops the robot. It still does after what `letGo` is for. */
  isStopping = false;
  #source = null; // XRInputSource
  #joints;
  #jointShape;
  #controller;
  #marker;
  #raycaster = new Raycaster();
  #place = new Vector3();
  #isAiming = false;
  #isClosed = false;
  #hasPlace = false;
  #to;

  constructor(xr, index, rig, { grip, joint, ray }, marker, to) {
    this.#to = to;
    this.#marker = marker;
    this.#controller = xr.getController(index);
    this.#controller.add(new Line(...ray));
    const body = new Mesh(...grip);
    xr.getControllerGrip(index).add(body);
    this.#joints = xr.getHand(index);
    this.#jointShape = joint;
    rig.add(this.#controller, xr.getControllerGrip(index), this.#joints);
    this.#controller.addEventListener("connected", ({ data }) => {
      this.#source = data;
      body.visible = !data.hand;
    });
    this.#controller.addEventListener("disconnected", () => {
      this.#source = null;
      this.isStopping = false;
      this.letGo();
      to.gone(this);
    });
    const stop = () => {
      this.isStopping = true;
      to.stop();
    };
    const goOn = () => (this.isStopping = false);
    this.#controller.addEventListener("selectstart", ({ data }) => {
      if (isStop(data)) stop();
      else to.target(this, this.#ray());
    });
    this.#controller.addEventListener("selectend", ({ data }) => isStop(data) && goOn());
    this.#controller.addEventListener("squeezestart", stop);
    this.#controller.addEventListener("squeezeend", goOn);
  }

  /** Whether it can stop the robot. */
  get canStop() {
    return this.#source !== null && (!this.#source.hand || isStop(this.#source));
  }

  step() {
    this.#dress();
    const { axes, buttons } = this.#source?.gamepad ?? NO_GAMEPAD;
    const isPressed = Boolean(buttons[2]?.pressed || buttons[3]?.pressed); // touchpad, stick
    const isPushed = isPressed || this.#closes() || axes[3] < (this.#isAiming ? LET_GO : PUSHED);
    if (isPushed) this.#hasPlace = this.#to.stand(this.#ray(), this.#place);
    if (isPushed && this.#hasPlace) mark(this.#marker, this.#place);
    else this.#marker.visible = false;
    if (this.#isAiming && !isPushed && this.#hasPlace) this.#to.teleport(this.#place);
    this.#isAiming = isPushed;
  }

  letGo() {
    this.#isAiming = this.#hasPlace = false;
    this.#marker.visible = false;
  }

  /** Return whether thumb and middle finger are closed. */
  #closes() {
    const { "thumb-tip": thumb, "middle-finger-tip": middle } = this.#joints.joints ?? {};
    if (!this.#source?.hand || !thumb?.visible || !middle?.visible) return (this.#isClosed = false);
    return (this.#isClosed = thumb.position.distanceTo(middle.position) < (this.#isClosed ? OPEN_M : CLOSED_M));
  }

  #ray() {
    along(this.#controller, this.#raycaster.ray);
    return this.#raycaster;
  }

  /** Draw the joints that have come. */
  #dress() {
    for (const joint of this.#joints.children) {
      if (!joint.children.length) joint.add(new Mesh(...this.#jointShape));
    }
  }
}

/** Return whether the trigger of an XRInputSource stops the robot: bare hands have nothing to squeeze. */
const isStop = ({ hand, handedness }) => Boolean(hand) && handedness === "left";
