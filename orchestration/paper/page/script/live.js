/**
 * The live part of the page: the form, what it asks of the workers, and what comes back.
 *
 * @typedef {import("./state.js").Data} Data
 * @typedef {import("./state.js").State} State
 * @typedef {import("./state.js").Setting} Setting
 */
import { block, json } from "../../../report/script/data.js";
import { commandOf, fromLink, linkOf, pathsOf, preset, runOf, structureOf, valueOf } from "./state.js";

const STEPS = 1000; // of a slider
const SHOWN_PER_SI = /** @type {Record<string, number>} */ ({ mm: 1e3, "%": 100 });

/** @param {string} id @returns {any} */
const element = (id) => document.getElementById(`live-${id}`);
/** @param {number} value @param {number} digits */
const short = (value, digits) => String(Number(value.toPrecision(digits)));

/** @param {import("../../../report/script/page.js").Context} context */
export async function start({ showRuns, runs }) {
  /** @type {Data} */
  const data = json("live-data");
  const loaded = Object.keys(data.controllers).map(async (name) => [name, await block(`loop-${name}`)]);
  const modules = Object.fromEntries(await Promise.all(loaded));
  const address = URL.createObjectURL(new Blob([json("live-worker")], { type: "text/javascript" }));
  const [drawer, judge] = [1, 2].map(() => new Worker(address));
  for (const worker of [drawer, judge]) worker.postMessage({ data, modules });
  let state = preset(data, "fig5");
  /** @type {any[]} */
  let pinned = [];
  /** @type {any} */
  let latest;
  let moved = false;

  /** @param {string} kind @param {Worker} worker */
  const ask = (kind, worker) => worker.postMessage({ kind, state });
  const say = (/** @type {string} */ words) => (element("status").textContent = words);
  const same = (/** @type {State} */ other) => linkOf(data, other) === linkOf(data, state);

  function refresh() {
    for (const setting of data.settings) show(setting);
    element("figure").value = state.figure;
    element("controller").value = state.controller;
    element("caption").textContent = data.figures[state.figure].caption;
    element("link").value = `${location.href.split("#")[0]}#${linkOf(data, state)}`;
    element("command").textContent = commandOf(data, state);
    element("hash").textContent = "not computed yet";
    element("native").textContent = "not compared yet";
    element("claims").setAttribute("aria-busy", "true");
    ask("show", drawer);
    ask("claims", judge);
  }

  /** @param {Setting} setting */
  function show(setting) {
    const value = valueOf(data, state, setting);
    const [field, slider] = [element(setting.key), element(`${setting.key}-slider`)];
    element(`${setting.key}-row`).hidden = value === undefined;
    if (value === undefined) return;
    complain(setting, "");
    const chosen = setting.options.findIndex((option) => option.value === value);
    if (setting.options.length) field.selectedIndex = chosen;
    else if (document.activeElement !== field) field.value = short(value * setting.factor, 7);
    if (slider && document.activeElement !== slider) slider.value = place(setting, value);
    element(`${setting.key}-row`).dataset.changed = String(setting.key in state.changes);
  }

  /** @param {Setting} setting @param {string} words */
  function complain(setting, words) {
    element(`${setting.key}-error`).textContent = words;
    if (words) element(setting.key).setAttribute("aria-invalid", "true");
    else element(setting.key).removeAttribute("aria-invalid");
  }

  /** @param {Setting} setting @param {number} value in the unit of the variables */
  function change(setting, value) {
    state = { ...state, changes: { ...state.changes, [setting.key]: value } };
    const before = { ...state, changes: { ...state.changes } };
    delete before.changes[setting.key];
    if (valueOf(data, before, setting) === valueOf(data, state, setting)) state = before;
    moved = true;
    refresh();
  }

  for (const setting of data.settings) {
    const [field, slider] = [element(setting.key), element(`${setting.key}-slider`)];
    field.addEventListener("input", () => {
      const typed = field.value.trim() === "" ? NaN : Number(field.value) / setting.factor;
      const value = setting.options.length ? setting.options[field.selectedIndex].value : typed;
      if (Number.isFinite(value)) change(setting, value);
      else complain(setting, `“${field.value}” is not a number; write one such as ${short(setting.high * setting.factor, 3)}.`);
    });
    slider?.addEventListener("input", () => change(setting, at(setting, Number(slider.value))));
    for (const input of [field, slider]) input?.addEventListener("blur", () => show(setting));
  }
  element("figure").addEventListener("change", () => {
    state = { ...preset(data, element("figure").value), changes: state.changes };
    moved = true;
    refresh();
  });
  element("controller").addEventListener("change", () => {
    state = { ...state, controller: element("controller").value };
    moved = true;
    refresh();
  });

  /** @type {Record<string, () => unknown>} */
  const actions = {
    reset: () => ((state = preset(data, state.figure)), refresh()),
    pin: () => latest && ((pinned = [...pinned, { ...latest, label: `${latest.label} (pinned)` }]), draw()),
    unpin: () => ((pinned = []), draw()),
    prove: () => ((element("hash").textContent = "computing ..."), ask("hash", judge)),
    csv: () => (say("Computing all rows ..."), ask("csv", judge)),
    ssd: () => save(`${state.figure}.ssd`, new Blob([structureOf(data, state)], { type: "application/xml" })),
    "copy-link": () => copy(element("link"), element("link").value),
    "copy-command": () => copy(element("command"), element("command").textContent),
  };
  for (const [name, act] of Object.entries(actions)) element(name).addEventListener("click", act);

  /** @param {any} from element to select if there is no clipboard @param {string} words */
  async function copy(from, words) {
    try {
      await navigator.clipboard.writeText(words);
      say("Copied.");
    } catch {
      getSelection()?.selectAllChildren(from);
      from.select?.();
      say("The clipboard is closed to this page; what to copy is selected.");
    }
  }

  const draw = () => showRuns(moved || pinned.length ? [latest, ...pinned].filter(Boolean) : runs.length ? runs : [latest]);
  for (const worker of [drawer, judge]) worker.addEventListener("message", ({ data: said }) => same(said.state) && receive(said));

  /** @param {any} said */
  async function receive(said) {
    if (said.error) fail(said.error);
    if (said.answer) answered(said.answer, said.milliseconds);
    if (said.csv) save(`${state.figure}.csv`, said.csv);
    if (said.hash) proved(said.hash);
    if (!said.rows) return;
    const { time, ...columns } = said.rows;
    const { values } = runOf(data, state);
    const lengths = [values["plant.l[1]"], values["plant.l[2]"]];
    const normal = [values["plant.wall_normal[1]"], values["plant.wall_normal[2]"]];
    const units = Object.fromEntries(data.controllers[state.controller].description.variables.map((v) => [v.name, v.unit]));
    const extra = { arm: { lengths, wall: { normal, offset: values["plant.wall_offset"] } } };
    latest = { label: label(), time, columns, units, held: data.held, phases: said.phases, extra };
    data.numbers.forEach(({ factor, unit }, i) => {
      const [pair, value] = [element("numbers").children[i], said.numbers[i]];
      pair.hidden = Number.isNaN(value);
      pair.lastElementChild.textContent = `${short(factor * value, 4)} ${unit}`;
    });
    say(`${label()}: answered in ${said.milliseconds.toFixed(0)} ms.`);
    element("status").dataset.milliseconds = said.milliseconds.toFixed(1);
    if (moved || !runs.length) await draw();
  }

  /** @param {string} words */
  function fail(words) {
    const [, component, variable] = /^(\w+): ([\w]+(?:\[\d+\])?)/.exec(words) ?? [];
    const named = data.settings.filter((s) => pathsOf(data, state, s).includes(`${component}.${variable}`));
    const about = named.find((s) => s.key in state.changes) ?? named[0];
    if (about) complain(about, words);
    say(`The run is refused. ${words}`);
    element("claims").removeAttribute("aria-busy");
  }

  /** @param {import("./claims.js").Answer} answer @param {number} milliseconds */
  function answered({ id, holds, values, why }, milliseconds) {
    const row = element(`claim-${id}`);
    row.dataset.holds = String(holds);
    row.cells[1].textContent = holds === null ? `cannot be judged: ${why}` : holds ? "holds" : "does not hold";
    for (const found of row.querySelectorAll("[data-criterion]")) {
      const { unit } = data.criteria[found.dataset.criterion];
      const shown = (/** @type {number} */ value) => `${short(value * (SHOWN_PER_SI[unit] ?? 1), 3)} ${unit}`.trim();
      found.textContent = values[found.dataset.criterion]?.map(shown).join(", ") ?? "-";
    }
    if (id !== data.claims[data.claims.length - 1].id) return;
    element("claims").removeAttribute("aria-busy");
    element("claims").dataset.milliseconds = milliseconds.toFixed(1);
  }

  /** @param {string} hash */
  function proved(hash) {
    const plain = linkOf(data, state) === linkOf(data, preset(data, state.figure));
    const native = data.figures[state.figure].hash;
    element("hash").textContent = hash;
    element("native").textContent = !plain
      ? "The command above says the hash of its rows; it is this one."
      : native === hash
        ? `adaptimp run ${state.figure} gave the same hash when this page was made: the bits are the same.`
        : `adaptimp run ${state.figure} gave ${native} when this page was made: the bits differ. Please report this.`;
  }

  function label() {
    const changes = Object.entries(state.changes).map(([key, value]) => {
      const setting = /** @type {Setting} */ (data.settings.find((s) => s.key === key));
      const option = setting.options.find((o) => o.value === value);
      return option ? `${setting.label}: ${option.label}` : `${key} = ${short(value * setting.factor, 4)} ${setting.unit}`.trim();
    });
    const own = state.controller === data.figures[state.figure].controller;
    return [`Live ${state.figure}`, ...(own ? [] : [data.controllers[state.controller].label]), ...changes].join(", ");
  }

  function follow() {
    const found = fromLink(data, location.hash);
    if (!found) return false;
    state = found.state;
    moved = true;
    refresh();
    if (found.unknown.length) say(`The link has what this page does not know: ${found.unknown.join(", ")}.`);
    return true;
  }
  addEventListener("hashchange", follow);
  if (!follow()) refresh();
}

/** @param {Setting} setting @param {number} value @returns {number} */
function place({ low, high, log }, value) {
  return Math.round(STEPS * (log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low)));
}

/** @param {Setting} setting @param {number} step @returns {number} */
function at({ low, high, log, whole, factor }, step) {
  const value = log ? low * (high / low) ** (step / STEPS) : low + ((high - low) * step) / STEPS;
  return whole ? Math.round(value) : Number((value * factor).toPrecision(3)) / factor;
}

/** @param {string} name @param {Blob} content */
function save(name, content) {
  const link = document.createElement("a");
  [link.href, link.download] = [URL.createObjectURL(content), name];
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
