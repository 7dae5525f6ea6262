// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace, Texture } from "../vendor/three.js";

const HIGH_M = 3;

/** The camera's newest image, decoded on another thread. */
export class Television {
  options = { compression: "cbor", image: { quality: 70, max_width: 640, adapt: true } };
  shown = 0; // pictures so far
  #material = new MeshBasicMaterial({ color: 0x111111 });
  mesh = new Mesh(new PlaneGeometry(HIGH_M * 4 / 3, HIGH_M), this.#material);
  #isDecoding = false;
  #next = null;
  #tell;

  /** @param {(words: string) => void} tell gets why a picture cannot be shown */
  constructor(tell) {
    this.#tell = tell;
  }

  show(message) {
    this.#next = message;
    if (!this.#isDecoding) this.#decode();
  }

  async #decode() {
    this.#isDecoding = true;
    while (this.#next) {
      const { data, format } = this.#next;
      this.#next = null;
      try {
        const type = format.includes("png") ? "image/png" : "image/jpeg";
        // upside down, because a texture begins at the bottom and WebGL does not turn bitmaps
        this.#put(await createImageBitmap(new Blob([data], { type }), { imageOrientation: "flipY" }));
      } catch (error) {
        this.#tell(say("image.unshown", { format, why: error.message }));
      }
    }
    this.#isDecoding = false;
  }

  #put(bitmap) {
    let texture = this.#material.map;
    const old = texture?.image;
    if (old?.width !== bitmap.width || old?.height !== bitmap.height) {
      texture?.dispose(); // its storage has a fixed size
      texture = new Texture();
      Object.assign(texture, { colorSpace: SRGBColorSpace, flipY: false, generateMipmaps: false, minFilter: LinearFilter });
      this.#material.map = texture;
      this.#material.color.set(0xffffff);
      this.#material.needsUpdate = true;
      this.mesh.scale.x = (bitmap.width / bitmap.height) * (3 / 4);
    }
    texture.image = bitmap;
    texture.needsUpdate = true;
    old?.close();
    this.shown += 1;
  }
}
