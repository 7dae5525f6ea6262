// SPDX-License-Identifier: Apache-2.0
/**
 * As much of Emscripten as a library of functions needs: it is evaluated once, at build time, and what
 * the program uses is printed into the build as text. So a function keeps nothing of what stood around it in
 * its file, and sees only what it depends on and the runtime.
 */

import vm from "node:vm";

/**
 * Links a library and returns its functions, which have their own memory.
 *
 * @param {string} source the .jslib
 * @param {string[]} used the functions that the program imports
 * @param {Uint8Array} memory wasm's
 * @returns {{functions: Record<string, Function>, grow: (memory: Uint8Array) => void}}
 */
export function link(source, used, memory) {
  const library = evaluate(source);
  const printed = new Map();
  used.forEach((name) => print(library, name, printed));
  // No UTF8ToString, stringToUTF8 or _malloc: not every version of Emscripten adds them unasked.
  const program = `"use strict"; var HEAPU8 = memory;
    ${[...printed.values()].join("\n")}
    return {
      functions: { ${used.map((name) => `${name}: _${name}`).join(", ")} },
      grow: function (memory) { HEAPU8 = memory; },
    };`;
  return new Function("memory", program)(memory);
}

function evaluate(source) {
  const context = {
    LibraryManager: { library: {} },
    mergeInto: (target, functions) => Object.assign(target, functions),
    autoAddDeps: (functions, dependency) => {
      for (const name of Object.keys(functions).filter((key) => !key.endsWith("__deps"))) {
        (functions[`${name}__deps`] ??= []).push(dependency);
      }
    },
  };
  vm.runInNewContext(source, context);
  return context.LibraryManager.library;
}

function print(library, name, printed) {
  if (printed.has(name)) {
    return;
  }
  if (!(name in library)) {
    throw new Error(`undefined symbol: ${name}`);
  }
  const identifier = name.startsWith("$") ? name.slice(1) : `_${name}`;
  printed.set(name, `var ${identifier} = ${text(library[name])};`);
  (library[`${name}__deps`] ?? []).forEach((dependency) => print(library, dependency, printed));
}

function text(value) {
  if (typeof value === "function") {
    const source = value.toString();
    // Methods, arrows and async functions: not every version can print them.
    if (!/^function\s*\(/.test(source)) {
      throw new Error(`not a plain function: ${source.slice(0, 40)}`);
    }
    return source;
  }
  if (typeof value === "object" && value !== null && !Array.isArray(value)) {
    const members = Object.keys(value).map((key) => `${key}: ${text(value[key])}`);
    return `{ ${members.join(", ")} }`;
  }
  return JSON.stringify(value);
}
