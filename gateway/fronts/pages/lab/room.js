// SPDX-License-Identifier: Apache-2.0
// The room: floor, walls, light. Its middle is where the odometry began, and its far wall is where the robot looked.

import {
  BoxGeometry, BufferGeometry, Color, Group, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  PlaneGeometry, RingGeometry, Scene, Vector3,
} from "../vendor/three.js";
import { token } from "../shared/dom.js";

/** Metres from its middle to a wall. */
export const HALF_M = 5;
const WALL_M = 4;
const THICK_M = 0.1;

/** The scene, in the colours of the page. */
export class Room {
  scene = new Scene();
  #painted = []; // [material, name of its colour]
  #walls = new Group();

  constructor() {
    this.scene.add(new HemisphereLight(0xffffff, 0x888888, 3));
    const floor = new Mesh(new PlaneGeometry(2 * HALF_M, 2 * HALF_M), this.material("surface"));
    floor.rotation.x = -Math.PI / 2;
    floor.position.y = -0.02; // below the grid's lines
    this.scene.add(floor, new LineSegments(squares(), this.material("quiet", LineBasicMaterial)));
    const material = this.material("line");
    for (const [x, z, turn] of [[0, -1, 0], [0, 1, 0], [-1, 0, 1], [1, 0, 1]]) {
      const wall = new Mesh(new BoxGeometry(2 * HALF_M + 3 * THICK_M, WALL_M, THICK_M), material);
      wall.position.set(x * (HALF_M + THICK_M), WALL_M / 2, z * (HALF_M + THICK_M));
      wall.rotation.y = (turn * Math.PI) / 2;
      this.#walls.add(wall);
    }
    this.scene.add(this.#walls);
    this.paint();
  }

  /** Take the walls away where what is known of the world reaches beyond them, so many metres from the middle. */
  open(reach) {
    this.#walls.visible = reach <= HALF_M;
  }

  /** The walls that are seen. */
  get walls() {
    return this.#walls.visible ? this.#walls.children : [];
  }

  /** Return a material in a colour of style.css, which follows from dark to light. */
  material(name, Material = MeshLambertMaterial) {
    const material = new Material();
    this.#paint(material, name);
    return material;
  }

  /** Return a ring for the floor, which marks a place. Hidden at first. */
  marker(colour, radius) {
    const marker = new Mesh(new RingGeometry(radius * 0.7, radius, 32), this.material(colour, MeshBasicMaterial));
    marker.rotation.x = -Math.PI / 2;
    marker.visible = false;
    this.scene.add(marker);
    return marker;
  }

  /** Take the colours from the page again. */
  paint() {
    for (const [material, name] of this.#painted) material.color.set(token(name));
    this.scene.background = new Color(token("ground"));
  }

  #paint(material, name) {
    this.#painted.push([material, name]);
    material.color.set(token(name));
  }
}

/** Return the lines of the floor, a metre apart, in pieces: a line that reaches behind the camera is not drawn everywhere. */
function squares() {
  const ends = [];
  for (let across = -HALF_M; across <= HALF_M; across += 1) {
    for (let from = -HALF_M; from < HALF_M; from += 1) {
      ends.push(new Vector3(across, 0, from), new Vector3(across, 0, from + 1));
      ends.push(new Vector3(from, 0, across), new Vector3(from + 1, 0, across));
    }
  }
  return new BufferGeometry().setFromPoints(ends);
}

/** Put a mark on the floor, a little above its lines. */
export function mark(marker, { x, z }) {
  marker.position.set(x, 0.01, z);
  marker.visible = true;
}
