/**
 * The live part of the page: the form, what it asks of the workers, and what comes back.
 *
 * @typedef {import("./state.js").Data} Data
 * @typedef {import("./state.js").State} State
 * @typedef {import("./state.js").Setting} Setting
 */
import { block, json } from "../../../report/script/data.js";
import { commandOf, fromLink, linkOf, preset, runOf, structureOf, valueOf } from "./state.js";

/** @param {string} id @returns {any} */
const element = (id) => document.getElementById(`live-${id}`);
/** @param {number} value @param {number} digits */
const short = (value, digits) => String(Number(value.toPrecision(digits)));
/** Give fields and outputs their values. @param {Record<string, string>} values by id */
const fill = (values) => Object.entries(values).forEach(([id, value]) => (element(id).value = value));

/** @param {import("../../../report/script/page.js").Context} context */
export async function start({ showRuns, runs }) {
  /** @type {Data} */
  const data = json("live-data");
  const loaded = Object.keys(data.controllers).map(async (name) => [name, await block(`loop-${name}`)]);
  const modules = Object.fromEntries(await Promise.all(loaded));
  const address = URL.createObjectURL(new Blob([json("live-worker")], { type: "text/javascript" }));
  const [drawer, judge] = [1, 2].map(() => new Worker(address));
  for (const worker of [drawer, judge]) {
    worker.postMessage({ data, modules });
    worker.addEventListener("message", ({ data: said }) => linkOf(data, said.state) === linkOf(data, state) && receive(said));
  }
  let [state, moved, latest] = [preset(data, "fig5"), false, /** @type {any} */ (undefined)];
  /** @type {any[]} */
  let pinned = [];

  const ask = (/** @type {string} */ kind, /** @type {Worker} */ worker) => worker.postMessage({ kind, state });
  const say = (/** @type {string} */ status) => fill({ status });
  const draw = () => showRuns(moved || pinned.length ? [latest, ...pinned].filter(Boolean) : runs.length ? runs : [latest]);

  /** @param {State} wanted */
  function show(wanted) {
    state = wanted;
    data.settings.forEach(showSetting);
    const { figure, controller } = state;
    const link = `${location.href.split("#")[0]}#${linkOf(data, state)}`;
    fill({ figure, controller, caption: data.figures[figure].caption, command: commandOf(data, state), link });
    fill({ hash: "not computed yet", native: "not compared yet" });
    element("claims").setAttribute("aria-busy", "true");
    ask("show", drawer);
    ask("claims", judge);
  }

  /** @param {Setting} setting */
  function showSetting(setting) {
    const { key, unit, factor, log } = setting;
    const [row, field, slider] = ["-row", "", "-slider"].map((part) => element(key + part));
    const value = valueOf(data, state, setting);
    row.hidden = value === undefined;
    if (value === undefined) return;
    complain(setting, "");
    row.dataset.changed = key in state.changes;
    if (document.activeElement !== field) field.value = short(value * factor, 7);
    if (slider) slider.ariaValueText = `${short(value * factor, 7)} ${unit}`;
    if (slider && document.activeElement !== slider) slider.value = log ? Math.log10(value * factor) : value * factor;
  }

  /** @param {Setting} setting @param {string} words */
  function complain({ key }, words) {
    fill({ [`${key}-error`]: words });
    element(key).ariaInvalid = words ? "true" : null;
  }

  /** What a changed field asks for, in the unit of the variables. @param {Setting} setting @param {any} field */
  function asked({ log, factor }, { type, value }) {
    if (type !== "range") return value.trim() === "" ? NaN : Number(value) / factor;
    return Number((log ? 10 ** value : Number(value)).toPrecision(3)) / factor;
  }

  /** @param {any} field */
  function change(field) {
    const setting = data.settings.find(({ key }) => key === field.name);
    if (field.name === "controller") return show({ ...state, controller: field.value });
    if (!setting) return show({ ...preset(data, field.value), changes: state.changes });
    const [value, example] = [asked(setting, field), short(setting.high * setting.factor, 3)];
    if (!Number.isFinite(value)) return complain(setting, `“${field.value}” is not a number; write one such as ${example}.`);
    const [before, after] = [state, state].map((of) => ({ ...of, changes: { ...of.changes, [setting.key]: value } }));
    delete before.changes[setting.key];
    return show(valueOf(data, before, setting) === valueOf(data, after, setting) ? before : after);
  }
  // Listens before the fields do, since not all events rise.
  element("form").addEventListener("input", (/** @type {any} */ { target }) => ((moved = true), change(target)), true);

  /** @type {Record<string, () => unknown>} */
  const actions = {
    reset: () => show(preset(data, state.figure)),
    pin: () => latest && ((pinned = [...pinned, { ...latest, label: `${latest.label} (pinned)` }]), draw()),
    unpin: () => ((pinned = []), draw()),
    prove: () => (fill({ hash: "computing ..." }), ask("hash", judge)),
    csv: () => (say("Computing all rows ..."), ask("csv", judge)),
    ssd: () => save(`${state.figure}.ssd`, new Blob([structureOf(data, state)], { type: "application/xml" })),
    "copy-link": () => copy("link"),
    "copy-command": () => copy("command"),
  };
  const copy = (/** @type {string} */ id) => navigator.clipboard.writeText(element(id).value).then(() => say("Copied."));
  for (const [name, act] of Object.entries(actions)) element(name).addEventListener("click", act);

  /** @param {any} said */
  async function receive(said) {
    if (said.error) fail(said.error);
    if (said.answer) answered(said.answer, said.milliseconds);
    if (said.csv) save(`${state.figure}.csv`, said.csv);
    if (said.hash) proved(said.hash);
    if (!said.rows) return;
    const { rows: { time, ...columns }, phases } = said;
    const { values } = runOf(data, state);
    const [lengths, normal] = ["l", "wall_normal"].map((name) => [1, 2].map((i) => values[`plant.${name}[${i}]`]));
    const extra = { arm: { lengths, normal, offset: values["plant.wall_offset"] } };
    latest = { label: label(), time, columns, units: data.units, held: data.held, phases, extra };
    data.numbers.forEach(({ factor, unit }, i) => {
      const [pair, value] = [element("numbers").children[i], said.numbers[i]];
      pair.hidden = Number.isNaN(value);
      pair.lastElementChild.textContent = `${short(factor * value, 4)} ${unit}`;
    });
    say(`${label()}: answered in ${said.milliseconds.toFixed(0)} ms.`);
    element("status").dataset.milliseconds = said.milliseconds.toFixed(1);
    if (moved || !runs.length) await draw();
  }

  /** @param {string} words such as ``controller: K[1] = -1 must be ...`` */
  function fail(words) {
    const [variable] = words.replace(": ", ".").split(" ");
    const named = data.settings.filter(({ key }) => data.starts[state.figure][state.controller].paths[key].includes(variable));
    const about = named.find(({ key }) => key in state.changes) ?? named[0];
    if (about) complain(about, words);
    say(`The run is refused. ${words}`);
    element("claims").removeAttribute("aria-busy");
  }

  /** @param {import("./claims.js").Answer} answer @param {number} milliseconds */
  function answered({ id, holds, values, why }, milliseconds) {
    const row = element(`claim-${id}`);
    row.dataset.holds = holds;
    row.cells[1].textContent = holds === null ? `cannot be judged: ${why}` : holds ? "holds" : "does not hold";
    for (const found of row.querySelectorAll("[data-criterion]")) {
      const { unit, factor } = data.criteria[found.dataset.criterion];
      const shown = (/** @type {number} */ value) => `${short(value * factor, 3)} ${unit}`.trim();
      found.textContent = values[found.dataset.criterion]?.map(shown).join(", ") ?? "-";
    }
    if (row.nextElementSibling) return;
    element("claims").removeAttribute("aria-busy");
    element("claims").dataset.milliseconds = milliseconds.toFixed(1);
  }

  /** @param {string} hash */
  function proved(hash) {
    const [{ figure }, plain] = [state, linkOf(data, state) === linkOf(data, preset(data, state.figure))];
    const native = data.figures[figure].hash;
    const said = native === hash ? ["the same hash", "the bits are the same."] : [native, "the bits differ. Please report this."];
    const compared = `adaptimp run ${figure} gave ${said[0]} when this page was made: ${said[1]}`;
    fill({ hash, native: plain ? compared : "The command above says the hash of its rows; it is this one." });
  }

  function label() {
    const changes = data.settings.filter(({ key }) => key in state.changes).map(({ key, options, factor, unit }) => {
      const option = options.find(({ value }) => value === state.changes[key]);
      return `${key} = ${option?.label ?? `${short(state.changes[key] * factor, 4)} ${unit}`}`.trim();
    });
    const own = state.controller === data.figures[state.figure].controller;
    return [`Live ${state.figure}`, ...(own ? [] : [data.controllers[state.controller].label]), ...changes].join(", ");
  }

  function follow() {
    const found = fromLink(data, location.hash);
    if (!found) return;
    moved = true;
    show(found.state);
    if (found.unknown.length) say(`The link has what this page does not know: ${found.unknown.join(", ")}.`);
  }
  addEventListener("hashchange", follow);
  if (!fromLink(data, location.hash)) show(state);
  follow();
}

/** @param {string} name @param {Blob} content */
function save(name, content) {
  const link = document.createElement("a");
  [link.href, link.download] = [URL.createObjectURL(content), name];
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
