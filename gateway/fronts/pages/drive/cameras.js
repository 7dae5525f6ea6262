// SPDX-License-Identifier: Apache-2.0
// The list of cameras. The chosen one is in the address, as one that was typed there.

import { element } from "../shared/dom.js";
import { choose, isOf, published } from "../shared/named_topics.js";

/**
 * Let a list choose the camera.
 * @param {HTMLSelectElement} list
 * @param {import("../shared/gateway.js").Gateway} gateway
 * @param {() => void} chosen is called when another one is chosen
 */
export function listCameras(list, gateway, chosen) {
  const write = () => {
    const names = [...gateway.graph.topics.values()]
      .filter(({ publishers, types }) => publishers.length && isOf(types[0], "camera")).map(({ name }) => name).sort();
    const shown = published(gateway.graph, "camera");
    const listed = [...list.options].map(({ value }) => value);
    list.closest("label").hidden = names.length < 2;
    if (names.join() !== listed.join()) list.replaceChildren(...names.map((value) => element("option", { value }, value)));
    list.value = shown;
  };
  gateway.on("graph", write);
  list.onchange = () => {
    choose("camera", list.value);
    list.blur(); // or the arrow keys would choose another one, and not drive
    chosen();
  };
}
