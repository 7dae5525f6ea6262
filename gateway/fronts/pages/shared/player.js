// SPDX-License-Identifier: Apache-2.0
// The bar of a recording: play, pause, and a slider. Pages show it while the gateway plays one.

import { clock, element } from "./dom.js";
import { say } from "./language.js";
import { tell } from "./notice.js";

const NODE = "/rosbag2_player";
const STATE = `${NODE}/state`;
const RATES = [0.1, 0.5, 1, 2, 5, 10];
const SETTLED_MS = 1000; // the slider follows the player again so long after a person has moved it

/**
 * Return the bar, which hides while there is no player.
 * @param {import("./gateway.js").Gateway} gateway
 */
export function playerBar(gateway) {
  let state = null; // as the player tells it
  let stop = null; // the subscription
  let movedMs = -Infinity;
  const toggle = element("button", { type: "button" });
  const slider = element("input", { type: "range", min: "0", step: "any", aria: { label: say("play.position") } });
  const time = element("output", { className: "quiet" });
  const rates = element("select", { aria: { label: say("play.speed") } }, ...RATES.map((rate) => element("option", { value: String(rate) }, `${rate}×`)));
  const bar = element("section", { id: "player", className: "player", hidden: true, aria: { label: say("play.bar") } }, toggle, slider, time, rates);

  const call = async (name, args = {}) => {
    try {
      const { result, values } = await gateway.ask({ op: "call_service", service: `${NODE}/${name}`, args });
      if (!result) tell(String(values));
    } catch (error) {
      tell(error.message);
    }
  };
  const show = () => {
    const length = state.end - state.start;
    toggle.textContent = state.paused ? say("play.go") : say("play.pause");
    slider.max = String(length);
    if (performance.now() - movedMs > SETTLED_MS) slider.value = String(state.position - state.start);
    slider.setAttribute("aria-valuetext", clock(Number(slider.value)));
    time.textContent = `${clock(Number(slider.value))} / ${clock(length)}`;
    if (document.activeElement !== rates) rates.value = String(state.rate);
  };
  toggle.onclick = () => call(state.paused ? "resume" : "pause");
  rates.onchange = () => call("set_rate", { rate: Number(rates.value) });
  slider.oninput = () => {
    movedMs = performance.now();
    const position = state.start + Number(slider.value);
    const sec = Math.floor(position);
    call("seek", { time: { sec, nanosec: Math.floor((position - sec) * 1e9) } });
    show();
  };
  gateway.on("graph", () => {
    const isThere = gateway.graph.topics.has(STATE) && gateway.graph.services.has(`${NODE}/seek`);
    bar.hidden = !isThere || state === null;
    if (isThere && !stop) {
      const take = ({ data }) => {
        state = JSON.parse(data);
        bar.hidden = false;
        show();
      };
      stop = gateway.subscribe(STATE, { type: "std_msgs/msg/String" }, take, () => {});
    } else if (!isThere && stop) {
      stop();
      stop = state = null;
    }
  });
  return bar;
}
