// SPDX-License-Identifier: Apache-2.0
import { bytes, element } from "../shared/dom.js";
import { json } from "../shared/json.js";

const MOST = 20_000; // characters. The rest of a point cloud helps nobody

/** The newest frame as wscat would show it: a text as it came, every digit of it. CBOR, which wscat cannot show, as JSON. */
export class RawView {
  static title = "Frames";

  options = { throttle_rate: 50 };
  element = element("pre", { className: "raw", tabIndex: 0 });

  show(message, data) {
    const text = typeof data === "string" ? data : `CBOR of ${bytes(data.byteLength)}, its message as JSON:\n${json(message)}`;
    this.element.textContent = text.length > MOST ? `${text.slice(0, MOST)} ... ${text.length} characters` : text;
  }
}
