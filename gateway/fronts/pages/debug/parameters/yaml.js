// SPDX-License-Identifier: Apache-2.0
// Files of parameters, as `ros2 param dump` and `ros2 param load` have them: the part of YAML that ROS reads.

import { say } from "../../shared/language.js";

const PLAIN = /^[A-Za-z_][A-Za-z0-9_./-]*$/; // a text that needs no quotes
const BOOLEANS = { true: "true", True: "true", TRUE: "true", yes: "true", on: "true", false: "false", False: "false", FALSE: "false", no: "false", off: "false" };
const NUMBER = /^[-+]?(\d+|\d+\.\d*|\.\d+)([eE][-+]?\d+)?$/;
const NON_FINITE = { ".nan": '"NaN"', ".inf": '"Infinity"', "+.inf": '"Infinity"', "-.inf": '"-Infinity"' };
const KEY = /^("(?:[^"\\]|\\.)*"|'(?:[^']|'')*'|[^\s#'"[{&*!|>%@`-][^#]*?|\/[^#]*?)\s*:(?:\s+(.*))?$/;
const COMMENT = /("(?:[^"\\]|\\.)*"|'(?:[^']|'')*')|(^|\s)#.*$/g; // or a text in quotes
const PARAMETERS = "ros__parameters";
const MOST_CHARACTERS = 1_000_000;

/**
 * Return the parameters of a node as YAML.
 * @param {string} node
 * @param {{name: string, type: string, value: any}[]} parameters
 */
export function written(node, parameters) {
  const lines = [`${node}:`, `  ${PARAMETERS}:`];
  let before = [];
  for (const { name, type, value } of [...parameters].sort((one, other) => (one.name < other.name ? -1 : 1))) {
    if (value === null) continue; // declared without a value
    const path = name.split(".");
    const shared = path.slice(0, -1).findIndex((each, at) => before[at] !== each);
    for (let at = shared < 0 ? path.length - 1 : shared; at < path.length - 1; at += 1) lines.push(`${"  ".repeat(at + 2)}${path[at]}:`);
    before = path.slice(0, -1);
    lines.push(`${"  ".repeat(path.length + 1)}${path.at(-1)}: ${scalar(type, value)}`);
  }
  return `${lines.join("\n")}\n`;
}

function scalar(type, value) {
  if (type === "byte_array") return `[${[...atob(value)].map((each) => each.charCodeAt(0)).join(", ")}]`;
  if (Array.isArray(value)) return `[${value.map((each) => scalar(type.replace("_array", ""), each)).join(", ")}]`;
  if (type === "string") return PLAIN.test(value) && !(value in BOOLEANS) ? value : JSON.stringify(value);
  if (type !== "double") return String(value);
  if (typeof value === "string") return { NaN: ".nan", Infinity: ".inf", "-Infinity": "-.inf" }[value] ?? value;
  return /[.e]/.test(String(value)) ? String(value) : `${value}.0`;
}

/**
 * Return the values for a node in a file, as JSON texts by name. Of several that fit, the last one counts.
 * @param {string} text
 * @param {string} node with its namespace
 * @returns {Map<string, string>}
 * @throws {Error} in words, with the line
 */
export function read(text, node) {
  if (text.length > MOST_CHARACTERS) throw new Error(say("yaml.large", { count: text.length, most: MOST_CHARACTERS }));
  const found = new Map();
  const collect = (group, names) => {
    for (const [key, value] of group) {
      if (key !== PARAMETERS) {
        if (value instanceof Map) collect(value, [...names, ...key.split("/").filter(Boolean)]);
      } else if (value instanceof Map && fits(names, node)) flatten(value, "", found);
    }
  };
  collect(new Reader(text).read(), []);
  return found;
}

/** Whether names of a file, which may have * and **, mean a node. */
function fits(names, node) {
  const pattern = names.map((each) => (each === "**" ? "(/[^/]+)*" : `/${each.replaceAll(/[.+?^${}()|[\]\\]/g, "\\$&").replaceAll("*", "[^/]*")}`)).join("");
  return new RegExp(`^${pattern}$`).test(node);
}

function flatten(group, before, found) {
  for (const [key, value] of group) {
    if (value instanceof Map) flatten(value, `${before}${key}.`, found);
    else found.set(before + key, value);
  }
}

/** Reads groups by their indentation. Values become JSON texts. */
class Reader {
  #lines;
  #at = 0;

  constructor(text) {
    this.#lines = text.split(/\r?\n/).map((line, index) => ({ number: index + 1, indent: line.search(/\S|$/), text: uncommented(line).trim() })).filter((each) => each.text && each.text !== "---" && each.text !== "...");
    const tab = text.split("\n").findIndex((line) => /^ *\t/.test(line));
    if (tab >= 0) throw new Error(say("yaml.tab", { line: tab + 1 }));
  }

  read() {
    const group = this.#group(this.#lines[0]?.indent ?? 0);
    if (this.#at < this.#lines.length) this.#refuse(say("yaml.indentation"));
    return group;
  }

  #group(indent) {
    const group = new Map();
    while (this.#at < this.#lines.length && this.#lines[this.#at].indent === indent) {
      const [, quoted, rest = ""] = KEY.exec(this.#lines[this.#at].text) ?? this.#refuse(say("yaml.name"));
      const key = plain(quoted);
      if (rest) {
        group.set(key, this.#value(rest));
        this.#at += 1;
      } else {
        this.#at += 1;
        const next = this.#lines[this.#at];
        if (next?.text.startsWith("- ") && next.indent >= indent) group.set(key, this.#list(next.indent));
        else group.set(key, next && next.indent > indent ? this.#group(next.indent) : new Map());
      }
    }
    return group;
  }

  #list(indent) {
    const items = [];
    for (; this.#at < this.#lines.length && this.#lines[this.#at].indent === indent && this.#lines[this.#at].text.startsWith("- "); this.#at += 1) {
      items.push(this.#value(this.#lines[this.#at].text.slice(2).trim()));
    }
    return `[${items.join(",")}]`;
  }

  #value(text) {
    if (text === "{}") return new Map();
    if (/^[&*!|>{%@`]/.test(text)) this.#refuse(say("yaml.value", { sign: text[0] }));
    if (!text.startsWith("[")) return valueOf(text);
    let whole = text; // a list may go on in the lines below
    while (!whole.endsWith("]") && this.#at + 1 < this.#lines.length) whole += ` ${this.#lines[(this.#at += 1)].text}`;
    if (!whole.endsWith("]")) this.#refuse(say("yaml.list"));
    const items = whole.slice(1, -1).match(/"(?:[^"\\]|\\.)*"|'(?:[^']|'')*'|[^,\s][^,]*/g) ?? [];
    return `[${items.map((each) => valueOf(each.trim())).join(",")}]`;
  }

  /** @returns {never} */
  #refuse(why) {
    throw new Error(say("yaml.line", { line: this.#lines[this.#at].number, why }));
  }
}

/** Return a line without its comment. */
const uncommented = (line) => line.replace(COMMENT, (all, quoted) => quoted ?? "");

/** Return a text without its quotes. */
function plain(text) {
  if (text.startsWith('"')) return JSON.parse(text);
  return text.startsWith("'") ? text.slice(1, -1).replaceAll("''", "'") : text;
}

/** Return a value as JSON. */
function valueOf(text) {
  if (/^["']/.test(text)) return JSON.stringify(plain(text));
  if (text in BOOLEANS) return BOOLEANS[text];
  if (text.toLowerCase() in NON_FINITE) return NON_FINITE[text.toLowerCase()];
  if (text === "null" || text === "~") return "null";
  if (!NUMBER.test(text)) return JSON.stringify(text);
  return text.replace(/^\+/, "").replace(/^(-?)0+(?=\d)/, "$1").replace(/^(-?)\./, "$10.").replace(/\.(?=$|[eE])/, ".0");
}
