// SPDX-License-Identifier: Apache-2.0
// The marks of the tools in a scene: an arrow for a pose that is being given, a goal, and a measured distance.

import { say } from "../shared/language.js";
import { BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, RingGeometry, SphereGeometry, Vector3 } from "../vendor/three.js";
import { dispose } from "./display.js";
import { label } from "./label.js";
import { arrowGeometry } from "./poses.js";

const COLOUR = { go: "#3fb950", place: "#f2b84b", measure: "#ffffff" };

/** A flat arrow on the floor, with a ring where it begins. */
export function poseArrow(kind) {
  const made = new Group();
  const material = new MeshBasicMaterial({ color: COLOUR[kind], depthTest: false, transparent: true });
  made.add(new Mesh(arrowGeometry().scale(0.6, 0.5, 0.02), material), new Mesh(new RingGeometry(0.1, 0.14, 32), material));
  made.renderOrder = 10;
  made.visible = false;
  return made;
}

/** Places that a user has pointed at, one or two, with what they say. */
export class Measure {
  object = new Group();
  /** @type {any[]} */
  places = [];

  /** Take a place more. The third begins again. Return the words. */
  add(place, most) {
    if (this.places.length >= most) this.places = [];
    this.places.push(place.clone());
    this.#draw();
    return this.words;
  }

  clear() {
    this.places = [];
    this.#draw();
  }

  get words() {
    const [from, to] = this.places;
    if (!from) return "";
    const at = ({ x, y, z }) => `x ${x.toFixed(3)}, y ${y.toFixed(3)}, z ${z.toFixed(3)} m`;
    return to ? say("measure.from", { metres: from.distanceTo(to).toFixed(3), from: at(from), to: at(to) }) : at(from);
  }

  #draw() {
    dispose(this.object);
    this.object.clear();
    for (const each of this.places) {
      const dot = new Mesh(new SphereGeometry(0.03, 12, 8), new MeshBasicMaterial({ color: COLOUR.measure, depthTest: false }));
      dot.position.copy(each);
      this.object.add(dot);
    }
    const [from, to] = this.places;
    if (!to) return;
    const line = new Line(new BufferGeometry().setFromPoints(this.places), new LineBasicMaterial({ color: COLOUR.measure, depthTest: false }));
    const text = label(`${from.distanceTo(to).toFixed(2)} m`, 0.15);
    text.position.copy(new Vector3().addVectors(from, to).multiplyScalar(0.5));
    this.object.add(line, text);
  }
}
