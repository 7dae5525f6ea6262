// SPDX-License-Identifier: Apache-2.0
import { element, token } from "../../shared/dom.js";

const SIZE = 480; // pixels
const MARGIN = 12;

/** A laser scan from above: forward is up, as REP 103 has x. */
export class ScanView {
  options = { compression: "cbor", throttle_rate: 50 };
  #canvas = element("canvas", { className: "picture", width: SIZE, height: SIZE, role: "img" });

  constructor(card) {
    this.element = this.#canvas;
    this.#canvas.setAttribute("aria-label", `laser scan of ${card.topic}, seen from above`);
  }

  show({ ranges, angle_min: first, angle_increment: step, range_min: least, range_max: most }) {
    const known = ranges.filter((each) => each >= least && each <= most);
    const farthest = Math.max(1, ...known.slice(0, 10_000));
    const scale = (SIZE / 2 - MARGIN) / farthest;
    const pen = this.#canvas.getContext("2d");
    pen.clearRect(0, 0, SIZE, SIZE);
    pen.strokeStyle = token("line");
    pen.fillStyle = token("quiet");
    pen.font = "12px system-ui";
    for (let metres = ringOf(farthest); metres <= farthest; metres += ringOf(farthest)) {
      pen.beginPath();
      pen.arc(SIZE / 2, SIZE / 2, metres * scale, 0, 2 * Math.PI);
      pen.stroke();
      pen.fillText(`${metres} m`, SIZE / 2 + 3, SIZE / 2 - metres * scale - 3);
    }
    pen.fillStyle = token("accent");
    ranges.forEach((range, index) => {
      if (!(range >= least && range <= most)) return;
      const angle = first + index * step;
      pen.fillRect(
        SIZE / 2 - Math.sin(angle) * range * scale - 1.5,
        SIZE / 2 - Math.cos(angle) * range * scale - 1.5,
        3,
        3,
      );
    });
    pen.fillStyle = token("text");
    pen.beginPath();
    pen.moveTo(SIZE / 2, SIZE / 2 - 8);
    pen.lineTo(SIZE / 2 - 5, SIZE / 2 + 6);
    pen.lineTo(SIZE / 2 + 5, SIZE / 2 + 6);
    pen.fill();
  }
}

/** Return the distance between rings: 1, 2 or 5 of a power of ten, three to seven rings. */
function ringOf(metres) {
  const power = 10 ** Math.floor(Math.log10(metres / 3));
  return power * ([5, 2, 1].find((each) => each * power <= metres / 3) ?? 1);
}
