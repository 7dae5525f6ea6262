// SPDX-License-Identifier: Apache-2.0
// The button that records the robot, and its panel: how much there is, a mark, and the end.

import { bytes, clock, element } from "./dom.js";
import { count, say } from "./language.js";
import { tell } from "./notice.js";

const MAX_TEXT = 200; // characters, as the gateway takes them

/**
 * Return the button and its panel, which lies above the page. They hide from a role that may not record.
 * @param {import("./gateway.js").Gateway} gateway
 */
export function recorder(gateway) {
  let state = "stopped";
  const button = element("button", { id: "record", type: "button", hidden: true }, say("record.state.stopped"));
  const amount = element("p", { className: "quiet" });
  const text = element("input", { type: "text", maxLength: MAX_TEXT, required: true });
  const mark = element("form", {}, element("label", {}, say("record.note"), text), element("button", { type: "submit" }, say("record.mark")));
  const end = element("button", { type: "button" }, say("record.stop"));
  const panel = element("section", { id: "recorder", hidden: true, aria: { label: say("record.panel") } }, amount, mark, end);

  const ask = async (action, more = {}) => {
    try {
      return await gateway.ask({ op: "record", action, ...more });
    } catch (error) {
      tell(error.message);
      return null;
    }
  };
  const open = (isOpen) => {
    panel.hidden = !isOpen;
    button.setAttribute("aria-expanded", String(isOpen));
  };
  const show = (frame) => {
    if (frame.state === "stopped" && state !== "stopped") {
      open(false);
      if (frame.why) tell(say("record.ended", { why: frame.why }));
    }
    ({ state } = frame);
    button.hidden = !frame.may_record;
    button.disabled = false;
    button.textContent = say(`record.state.${state}`);
    button.dataset.state = state;
    end.disabled = state !== "recording";
    const missing = frame.dropped + frame.lost;
    if (frame.recording) amount.textContent = [count("list.topic", frame.topics), bytes(frame.bytes), clock(frame.duration_s), ...(missing ? [say("record.missing", { count: missing })] : [])].join(", ");
  };
  button.onclick = async ({ detail }) => {
    if (detail) button.blur(); // or the space bar would press it, and not STOP
    if (state !== "stopped") open(panel.hidden);
    else if (await ask("start")) open(true);
  };
  mark.onsubmit = async (event) => {
    event.preventDefault();
    if (await ask("mark", { text: text.value })) text.value = "";
  };
  end.onclick = async () => {
    const made = await ask("stop");
    if (made && !made.why) tell(say("record.saved", { name: made.recording, size: bytes(made.bytes) }));
  };
  const { id } = gateway.listen((frame) => frame.op === "record" && show(frame));
  gateway.on("state", ({ state: connection }) => {
    button.disabled = true; // until the gateway has answered
    if (connection === "open") gateway.send({ op: "record", id, watch: true });
    else open(false);
  });
  return { button, panel };
}
