// SPDX-License-Identifier: Apache-2.0
import { element } from "../../shared/dom.js";
import { json, parse } from "../../shared/json.js";
import { count, say } from "../../shared/language.js";
import { Control, TAKEN } from "./control.js";
import { read, written } from "./yaml.js";

const FEW = 12; // parameters below a name: so many are shown at once
const FREED_MS = 10_000; // by then a browser has read a file that it saves

/** The parameters of a node as a tree by the dots in their names. They can be filtered, set, saved and loaded. */
export class Parameters {
  element = element("div", { className: "parameters" });
  #gateway;
  #node;
  #tell;
  #said;
  #controls = new Map(); // name -> Control
  #tree = element("div", { className: "form" });
  #filter;
  #changed;
  #file;

  /**
   * @param {import("../../shared/gateway.js").Gateway} gateway
   * @param {string} node
   * @param {{tell: (problem: string) => void, said: (words: string) => void}} card
   */
  constructor(gateway, node, { tell, said }) {
    this.#gateway = gateway;
    this.#node = node;
    this.#tell = tell;
    this.#said = said;
    this.#filter = element("input", { type: "search", placeholder: say("parameters.filter"), autocomplete: "off", aria: { label: say("parameters.filter.of", { node }) }, oninput: () => this.#show() });
    this.#changed = element("button", { type: "button", title: say("parameters.changed.about"), aria: { pressed: "false", label: say("parameters.changed.of", { node }) } }, say("parameters.changed"));
    this.#changed.onclick = () => {
      this.#changed.setAttribute("aria-pressed", String(this.#changed.ariaPressed !== "true"));
      this.#show();
    };
    const save = button(say("parameters.save"), say("parameters.save.of", { node }), () => this.#save());
    const load = button(say("parameters.load"), say("parameters.load.of", { node }), () => this.#file.click());
    this.#file = element("input", { type: "file", accept: ".yaml,.yml", hidden: true, aria: { label: say("parameters.file.of", { node }) } });
    this.#file.onchange = () => this.#load();
    this.#tree.addEventListener(TAKEN, () => this.#show());
    this.element.append(element("div", { className: "tools" }, this.#filter, this.#changed, save, load, this.#file), this.#tree);
  }

  /** Ask the node for its parameters. */
  async fetch() {
    this.#tell("");
    const node = this.#node;
    try {
      const [{ values }, { parameters }] = await Promise.all([
        this.#gateway.ask({ op: "get_parameters", node }),
        this.#gateway.ask({ op: "describe_parameters", node }),
      ]);
      const names = Object.keys(values).sort();
      this.#controls = new Map();
      this.#tree.replaceChildren(...this.#branch(names, 0, values, parameters));
      this.#said(names.length ? count("parameters.count", names.length) : say("parameters.none"));
      this.#show();
    } catch (error) {
      this.#tell(error.message);
    }
  }

  /** Return what stands below some names, which share so many of their parts. */
  #branch(names, depth, values, parameters) {
    const groups = new Map();
    for (const name of names) {
      const parts = name.split(".");
      const key = parts.length > depth + 1 ? parts[depth] : "";
      groups.set(key, [...(groups.get(key) ?? []), name]);
    }
    return [...groups].flatMap(([key, its]) => {
      if (!key) return its.map((name) => this.#control(name, depth, values[name], parameters[name] ?? {}).element);
      const children = this.#branch(its, depth + 1, values, parameters);
      return element("details", { open: names.length <= FEW }, element("summary", {}, `${key} (${its.length})`), element("div", { className: "group" }, ...children));
    });
  }

  #control(name, depth, value, about) {
    const control = new Control(name, name.split(".").slice(depth).join("."), value, about, (...set) => this.#set(...set));
    this.#controls.set(name, control);
    return control;
  }

  /** Set a parameter to a JSON text, and return why the node refuses it. */
  async #set(name, text) {
    const [problem] = await this.#setAll([[name, text]]);
    if (!problem) this.#said(say("parameters.set", { name }));
    return problem;
  }

  /** Set parameters to JSON texts, and return for each why the node refuses it, or "". */
  async #setAll(values) {
    const members = values.map(([name, text]) => `${JSON.stringify(name)}:${text}`);
    try {
      const { results } = await this.#gateway.ask({ op: "set_parameters", node: this.#node }, { values: `{${members.join(",")}}` });
      return values.map(([name]) => (results[name].successful ? "" : results[name].reason || say("parameters.refused")));
    } catch (error) {
      return values.map(() => error.message);
    }
  }

  /** Show what the filter lets through. */
  #show() {
    const wanted = this.#filter.value.toLowerCase();
    const onlyChanged = this.#changed.ariaPressed === "true";
    for (const [name, control] of this.#controls) control.element.hidden = !name.toLowerCase().includes(wanted) || (onlyChanged && !control.isChanged);
    for (const group of this.#tree.querySelectorAll("details")) {
      group.hidden = !group.querySelector(".parameter:not([hidden])");
      if (wanted || onlyChanged) group.open = true;
    }
    const changed = [...this.#controls.values()].filter(({ isChanged }) => isChanged).length;
    this.#changed.textContent = say("parameters.changed") + (changed ? ` (${changed})` : "");
  }

  #save() {
    const parameters = [...this.#controls].map(([name, { about: { type = "" }, json: text }]) => ({ name, type, value: parse(text) }));
    const href = URL.createObjectURL(new Blob([written(this.#node, parameters)], { type: "application/yaml" }));
    element("a", { href, download: `${this.#node.slice(1).replaceAll("/", "-")}.yaml` }).click();
    setTimeout(() => URL.revokeObjectURL(href), FREED_MS);
  }

  async #load() {
    const [file] = this.#file.files;
    this.#file.value = ""; // the same file may be loaded again
    if (!file) return;
    try {
      const found = read(await file.text(), this.#node);
      const known = [...found].filter(([name]) => this.#controls.has(name));
      const others = known.filter(([name, text]) => !isSame(text, this.#controls.get(name).json));
      const problems = others.length ? await this.#setAll(others) : [];
      others.forEach(([name, text], at) => {
        this.#controls.get(name).tell(problems[at]);
        if (!problems[at]) this.#controls.get(name).take(text);
      });
      this.#show();
      const refused = problems.filter(Boolean).length;
      const unknown = found.size - known.length;
      this.#said([
        say("parameters.sum.set", { count: others.length - refused }), say("parameters.sum.same", { count: known.length - others.length }),
        refused && say("refused", { count: refused }), unknown && say("parameters.sum.unknown", { count: unknown }),
      ].filter(Boolean).join(", "));
      this.#tell(found.size ? "" : say("parameters.empty", { file: file.name, node: this.#node }));
    } catch (error) {
      this.#tell(`${file.name}: ${error.message}`);
    }
  }
}

/** Whether two JSON texts say the same: a double may be written as an integer. */
const isSame = (one, other) => json(parse(one)) === json(parse(other));

function button(text, label, onclick) {
  return element("button", { type: "button", title: label, aria: { label }, onclick }, text);
}
