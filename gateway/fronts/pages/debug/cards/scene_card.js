// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { say } from "../../shared/language.js";
import { Card } from "./card.js";

/** The world in three dimensions. Its code comes with the first such card: it is as large as the rest of the page. */
export class SceneCard extends Card {
  /** @type {import("../../scene/scene.js").SceneView|null} */
  scene = null;
  #isClosed = false;

  constructor(gateway, shown, actions) {
    super(gateway, shown, actions, { title: say("scene") });
    this.element.classList.add("scene-card");
    this.body.append(element("p", {}, say("scene.loading")));
    this.#load();
  }

  get shown() {
    const fields = this.scene?.kept ?? this.fields;
    return { ...super.shown, fields };
  }

  draw() {
    this.scene?.draw();
  }

  tick() {
    this.scene?.tick();
  }

  wake() {
    super.wake();
    this.scene?.wake();
  }

  close() {
    this.#isClosed = true;
    this.scene?.close();
    super.close();
  }

  async #load() {
    try {
      const { SceneView } = await import("../../scene/scene.js");
      if (this.#isClosed) return;
      this.scene = new SceneView(this.gateway, this.fields, this.actions.changed, this);
      this.body.replaceChildren(this.scene.element);
      this.scene.tick();
    } catch (error) {
      this.tell(say("scene.failed", { why: error.message }));
    }
  }
}
