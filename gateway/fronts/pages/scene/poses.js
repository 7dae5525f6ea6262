// SPDX-License-Identifier: Apache-2.0
import { BufferGeometry, ConeGeometry, DoubleSide, Group, InstancedMesh, Line, LineBasicMaterial, Matrix4, MeshLambertMaterial, Quaternion, Vector3 } from "../vendor/three.js";
import { Display, dispose, put } from "./display.js";

const MOST_POSES = 5000; // of an array: further ones are not drawn
const SIGMAS = 2; // of an ellipse: 86 % of all places are within
const CORNERS = 48;

/** Return an arrow along x, 1 m long. */
export const arrowGeometry = () => new ConeGeometry(0.2, 1, 12).rotateZ(-Math.PI / 2).translate(0.5, 0, 0);

/** The poses of a message, as arrows: one, or an array. A covariance is an ellipse on the floor. */
export class PosesDisplay extends Display {
  #arrows = new Group();
  #ellipse = new Group();

  constructor(context, topic, look) {
    super(context, topic, look);
    this.object.add(this.#arrows, this.#ellipse);
  }

  #message = null;

  restyle() {
    if (this.#message) this.show(this.#message);
  }

  show(message) {
    this.#message = message;
    const poses = (message.poses ?? [message.pose.pose ?? message.pose]).slice(0, MOST_POSES);
    this.#draw(poses);
    dispose(this.#ellipse);
    this.#ellipse.clear();
    if (message.pose?.covariance) this.#spread(poses[0], message.pose.covariance);
  }

  #draw(poses) {
    dispose(this.#arrows);
    this.#arrows.clear();
    if (!poses.length) return;
    const mesh = new InstancedMesh(arrowGeometry(), new MeshLambertMaterial({ color: this.look.colour, side: DoubleSide }), poses.length);
    const [matrix, turn, scale] = [new Matrix4(), new Quaternion(), new Vector3(this.look.size, this.look.size, this.look.size)];
    poses.forEach(({ position, orientation: { x, y, z, w } }, at) => {
      turn.set(x, y, z, x || y || z || w ? w : 1);
      mesh.setMatrixAt(at, matrix.compose(new Vector3(position.x, position.y, position.z), turn, scale));
    });
    mesh.frustumCulled = false;
    this.#arrows.add(mesh);
  }

  /** Draw where the robot may be. */
  #spread(pose, covariance) {
    const [a, b, d] = [covariance[0], (covariance[1] + covariance[6]) / 2, covariance[7]];
    if (![a, b, d].every(Number.isFinite) || a + d <= 0) return;
    const root = Math.hypot((a - d) / 2, b);
    const [long, short] = [(a + d) / 2 + root, Math.max(0, (a + d) / 2 - root)].map((variance) => SIGMAS * Math.sqrt(variance));
    const turn = Math.atan2(2 * b, a - d) / 2;
    const corners = Array.from({ length: CORNERS + 1 }, (_, at) => {
      const [along, across] = [long * Math.cos((at / CORNERS) * 2 * Math.PI), short * Math.sin((at / CORNERS) * 2 * Math.PI)];
      return new Vector3(Math.cos(turn) * along - Math.sin(turn) * across, Math.sin(turn) * along + Math.cos(turn) * across, 0);
    });
    const line = new Line(new BufferGeometry().setFromPoints(corners), new LineBasicMaterial({ color: this.look.colour }));
    put(line, { position: pose.position, orientation: { x: 0, y: 0, z: 0, w: 1 } }); // the covariance is along the axes of the frame
    this.#ellipse.add(line);
  }
}
