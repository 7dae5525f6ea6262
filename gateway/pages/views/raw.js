// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { json } from "../shared/json.js";

const MOST = 20_000; // characters; the rest of a point cloud helps nobody

/** The newest frame as wscat would show it. */
export class RawView {
  options = { throttle_rate: 50 };
  element = element("pre", { className: "raw", tabIndex: 0 });

  show(_, frame) {
    const text = json(frame);
    this.element.textContent = text.length > MOST ? `${text.slice(0, MOST)} ... ${text.length} characters` : text;
  }
}
