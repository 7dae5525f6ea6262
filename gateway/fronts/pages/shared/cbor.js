// SPDX-License-Identifier: Apache-2.0
// Reads what the gateway sends in binary frames: CBOR (RFC 8949) with the typed arrays of RFC 8746.

import { narrowed } from "./json.js";

const TEXT = new TextDecoder("utf-8", { fatal: true });

const numbersOf = (Typed) => (octets) => new Typed(octets.slice().buffer); // a copy: a typed array begins at a multiple of its width
const TYPED_ARRAYS = {
  69: numbersOf(Uint16Array),
  70: numbersOf(Uint32Array),
  71: (octets) => Array.from(numbersOf(BigUint64Array)(octets), narrowed),
  72: (octets) => new Int8Array(octets.buffer, octets.byteOffset, octets.length),
  77: numbersOf(Int16Array),
  78: numbersOf(Int32Array),
  79: (octets) => Array.from(numbersOf(BigInt64Array)(octets), narrowed),
  85: numbersOf(Float32Array),
  86: numbersOf(Float64Array),
};

/**
 * Return the value of a frame. Byte strings are a `Uint8Array` into *buffer*, arrays of numbers typed arrays.
 * @param {ArrayBuffer} buffer
 * @returns {any}
 * @throws {RangeError|TypeError|SyntaxError} if it is not what the gateway sends
 */
export function decode(buffer) {
  const reader = new Reader(buffer);
  const value = reader.value();
  if (!reader.isAtEnd) throw new SyntaxError("something follows the value");
  return value;
}

class Reader {
  #view;
  #at = 0;

  constructor(buffer) {
    this.#view = new DataView(buffer);
  }

  get isAtEnd() {
    return this.#at === this.#view.byteLength;
  }

  value() {
    const first = this.#view.getUint8(this.#at++);
    const [major, info] = [first >> 5, first & 31];
    switch (major) {
      case 0: return this.#length(info);
      case 1: return narrowed(-1n - BigInt(this.#length(info)));
      case 2: return this.#octets(this.#length(info));
      case 3: return TEXT.decode(this.#octets(this.#length(info)));
      case 4: return this.#array(this.#length(info));
      case 5: return this.#map(this.#length(info));
      case 6: return this.#tagged(this.#length(info));
      default: return this.#simple(info);
    }
  }

  /** The number that follows the first byte, or stands in it. */
  #length(info) {
    if (info < 24) return info;
    const at = this.#at;
    switch (info) {
      case 24: this.#at += 1; return this.#view.getUint8(at);
      case 25: this.#at += 2; return this.#view.getUint16(at);
      case 26: this.#at += 4; return this.#view.getUint32(at);
      case 27: this.#at += 8; return narrowed(this.#view.getBigUint64(at));
      default: throw new SyntaxError(`a length of the kind ${info}`);
    }
  }

  #octets(count) {
    const octets = new Uint8Array(this.#view.buffer, this.#at, count); // throws beyond the end
    this.#at += count;
    return octets;
  }

  #array(count) {
    const items = [];
    while (items.length < count) items.push(this.value());
    return items;
  }

  #map(count) {
    const map = {};
    for (let left = count; left > 0; left -= 1) {
      const key = this.value();
      map[key] = this.value();
    }
    return map;
  }

  #tagged(tag) {
    const numbers = TYPED_ARRAYS[tag];
    if (!numbers) throw new SyntaxError(`a value of the tag ${tag}`);
    return numbers(this.value());
  }

  #simple(info) {
    switch (info) {
      case 20: return false;
      case 21: return true;
      case 22: return null;
      case 26: this.#at += 4; return this.#view.getFloat32(this.#at - 4);
      case 27: this.#at += 8; return this.#view.getFloat64(this.#at - 8);
      default: throw new SyntaxError(`a simple value ${info}`);
    }
  }
}
