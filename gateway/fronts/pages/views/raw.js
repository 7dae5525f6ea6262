// SPDX-License-Identifier: Apache-2.0
import { bytes, element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { json } from "../shared/json.js";

const MOST = 20_000; // characters. The rest of a point cloud helps nobody

/** The newest frame as wscat would show it: a text as it came, every digit of it. CBOR, which wscat cannot show, as JSON. */
export class RawView {
  static title = say("view.raw");

  options = { throttle_rate: 50 };
  element = element("pre", { className: "raw", tabIndex: 0 });

  show(message, data) {
    const text = typeof data === "string" ? data : `${say("raw.cbor", { size: bytes(data.byteLength) })}\n${json(message)}`;
    this.element.textContent = text.length > MOST ? `${text.slice(0, MOST)} ... ${say("characters", { count: text.length })}` : text;
  }
}
