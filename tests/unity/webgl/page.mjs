// SPDX-License-Identifier: Apache-2.0
/**
 * A page with the gateway's .jslib, driven line by line: `State 1` calls Ros2GatewaySocketState(1) and prints
 * its result. `b:` and base64 stands for a pointer to such bytes. `o:` and a capacity stands for a pointer to a
 * buffer. As many of its bytes as the function returned are printed behind its result.
 *
 * usage: node --experimental-websocket page.mjs LIBRARY [shared|high]
 */

import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import process from "node:process";
import { link } from "./emscripten.mjs";

const INPUT = 1024;
const OUTPUT = 24 * 1024 * 1024;
const MEMORY = 48 * 1024 * 1024;
const HIGH = 2 ** 31; // from here on, pointers are negative in wasm's signed integers

const NAMES = [
  "Open", "State", "FrameBytes", "Receive", "Send",
  "BufferedBytes", "Close", "CloseCode", "CloseReason", "Free",
];

/** Node 20 reports a failed connection by `error` alone. In browsers `close` always follows. */
class BrowserWebSocket extends WebSocket {
  constructor(url) {
    super(url);
    let isClosed = false;
    this.addEventListener("close", () => { isClosed = true; });
    this.addEventListener("error", () => setTimeout(() => {
      if (!isClosed) {
        this.dispatchEvent(Object.assign(new Event("close"), { code: 1006, reason: "" }));
      }
    }));
  }
}
globalThis.WebSocket = BrowserWebSocket;

/** Node decodes memory that threads share. Browsers refuse it. */
class BrowserTextDecoder extends TextDecoder {
  decode(view) {
    if (view.buffer instanceof SharedArrayBuffer) {
      throw new TypeError("must not be shared");
    }
    return super.decode(view);
  }
}
globalThis.TextDecoder = BrowserTextDecoder;

const [library, kind] = process.argv.slice(2);
const base = kind === "high" ? HIGH : 0;
let memory = kind === "shared"
  ? new Uint8Array(new SharedArrayBuffer(MEMORY))
  : new Uint8Array(base + MEMORY);
const { functions, grow } = link(
  readFileSync(library, "utf8"), NAMES.map((name) => `Ros2GatewaySocket${name}`), memory,
);

for await (const line of createInterface({ input: process.stdin })) {
  const [name, ...words] = line.split(" ");
  process.stdout.write(`${name === "!grow" ? growMemory() : call(name, words)}\n`);
}
process.exit();

function call(name, words) {
  let isOutput = false;
  const values = words.map((word) => {
    if (word.startsWith("b:")) {
      memory.set(Buffer.from(word.slice(2), "base64"), base + INPUT);
      return (base + INPUT) | 0;
    }
    if (word.startsWith("o:")) {
      isOutput = true;
      return (base + OUTPUT) | 0;
    }
    return Number(word);
  });
  const result = functions[`Ros2GatewaySocket${name}`](...values) ?? 0;
  const output = isOutput && result > 0
    ? Buffer.from(memory.slice(base + OUTPUT, base + OUTPUT + result)).toString("base64")
    : "";
  return `${result} ${output}`;
}

/** Does what wasm does when its memory grows: the old view is worth nothing any more. */
function growMemory() {
  const grown = new Uint8Array(memory.length + 65536);
  grown.set(memory);
  memory.fill(0xff);
  memory = grown;
  grow(memory);
  return "0 ";
}
