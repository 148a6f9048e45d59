/**
 * What the visitor asks for, as numbers of a run, as a link and as a command.
 *
 * @typedef {{key: string, label: string, unit: string, factor: number, paths: Record<string, string[]>, low: number, high: number,
 *   log: boolean, whole: boolean, ticks: boolean, group: string, reason: string,
 *   options: {value: number, label: string, values: Record<string, number>}[]}} Setting
 * @typedef {{caption: string, controller: string, step: number, stop: number, values: Record<string, number>,
 *   hash: string}} Figure
 * @typedef {{name: string, index: number, role: string, type: string, unit: string, start: number|null}} Variable
 * @typedef {{label: string, home: string, own: Record<string, number>, structure: string,
 *   description: {variables: Variable[]}}} Controller
 * @typedef {{comparison: string, limit: number, unit: string, text: string}} Criterion
 * @typedef {{figures: Record<string, Figure>, controllers: Record<string, Controller>, settings: Setting[],
 *   fixed: {name: string, value: string, reason: string}[], criteria: Record<string, Criterion>,
 *   claims: {id: string, measured: Record<string, number[]>, touches: number[]}[], nodes: import("./formulas.js").Node[],
 *   numbers: {value: number, factor: number, unit: string}[], phases: Record<string, number>,
 *   runs: Record<string, {figure: string, values: Record<string, number>}>, columns: Record<string, string[]>,
 *   drawn: string[], held: string[]}} Data
 * @typedef {{figure: string, controller: string, changes: Record<string, number>}} State
 * @typedef {{controller: string, step: number, stop: number, values: Record<string, number>}} Run
 */

const SAMPLING = "sample_time";

/**
 * Variables that a setting gives a value in a run. Gains of a controller that takes another one's place are those of its
 * own figure.
 * @param {Data} data @param {State} state @param {Setting} setting
 * @returns {string[]}
 */
export function pathsOf(data, state, setting) {
  const controller = data.controllers[state.controller];
  const switched = state.controller !== data.figures[state.figure].controller;
  const known = new Set(controller.description.variables.map((variable) => variable.name));
  /** @param {string} path */
  const figure = (path) => (switched && path.startsWith("controller.") ? controller.home : state.figure);
  return Object.keys(setting.paths).filter((path) => known.has(path) && setting.paths[path].includes(figure(path)));
}

/**
 * Start values that `adaptimp run FIGURE --controller X` has without further settings.
 * @param {Data} data @param {State} state
 * @returns {Record<string, number>}
 */
function given(data, state) {
  const { values } = data.figures[state.figure];
  const inputs = data.controllers[state.controller].description.variables.filter((v) => v.start !== null);
  return Object.fromEntries(inputs.map((v) => [v.name, values[v.name] ?? Number(v.start)]));
}

/** @param {Data} data @param {State} state @returns {Run} */
export function runOf(data, state) {
  const figure = data.figures[state.figure];
  const controller = data.controllers[state.controller];
  const values = given(data, state);
  if (state.controller !== figure.controller) Object.assign(values, controller.own);
  const step = state.changes[SAMPLING] ?? figure.step;
  for (const setting of data.settings) {
    const asked = state.changes[setting.key];
    const sampled = setting.ticks && SAMPLING in state.changes;
    if (asked === undefined && !sampled) continue;
    const chosen = setting.options.find((option) => option.value === asked);
    for (const path of pathsOf(data, state, setting)) {
      const value = chosen ? chosen.values[path] : (asked ?? values[path]);
      values[path] = setting.ticks ? wholeTicks(value, step) : value;
    }
  }
  for (const path of Object.keys(values)) if (path.endsWith(`.${SAMPLING}`)) values[path] = step;
  return { controller: state.controller, step, stop: figure.stop, values };
}

/** @param {number} period @param {number} step @returns {number} */
function wholeTicks(period, step) {
  const ticks = Math.max(1, Math.round(period / step));
  return ticks === 1 ? 0 : ticks * step;
}

/**
 * The value of a setting in a run; undefined if the run does not have it.
 * @param {Data} data @param {State} state @param {Setting} setting
 * @returns {number|undefined}
 */
export function valueOf(data, state, setting) {
  if (setting.key === SAMPLING) return state.changes[SAMPLING] ?? data.figures[state.figure].step;
  const paths = pathsOf(data, state, setting);
  if (!paths.length) return undefined;
  if (state.changes[setting.key] !== undefined && !setting.ticks) return state.changes[setting.key];
  const { values, step } = runOf(data, state);
  const held = setting.ticks ? values[paths[0]] || step : values[paths[0]];
  const option = setting.options.find(({ values: of }) => paths.every((path) => of[path] === values[path]));
  return option ? option.value : held;
}

/** @param {Data} data @param {string} figure @returns {State} */
export function preset(data, figure) {
  return { figure, controller: data.figures[figure].controller, changes: {} };
}

/** The command that gives the same rows. @param {Data} data @param {State} state @returns {string} */
export function commandOf(data, state) {
  const figure = data.figures[state.figure];
  const { values, step } = runOf(data, state);
  const before = given(data, state);
  const changed = Object.keys(values).filter((path) => values[path] !== before[path] && !path.endsWith(SAMPLING));
  return [
    `adaptimp run ${state.figure}`,
    ...(state.controller === figure.controller ? [] : [`--controller ${state.controller}`]),
    ...(step === figure.step ? [] : [`--sample-time ${step}`]),
    ...changed.map((path) => `--set "${path}=${values[path]}"`),
    "--hash",
  ].join(" ");
}

/** @param {Data} data @param {State} state @returns {string} what follows # in a link */
export function linkOf(data, state) {
  const words = new URLSearchParams({ try: state.figure });
  if (state.controller !== data.figures[state.figure].controller) words.set("controller", state.controller);
  for (const [key, value] of Object.entries(state.changes)) words.set(key, String(value));
  return words.toString();
}

/**
 * The state of a link; undefined if the link is of another part of the page.
 * @param {Data} data @param {string} text
 * @returns {{state: State, unknown: string[]}|undefined}
 */
export function fromLink(data, text) {
  const words = new URLSearchParams(text.replace(/^#/, ""));
  const figure = words.get("try");
  if (figure === null) return undefined;
  const unknown = Object.hasOwn(data.figures, figure) ? [] : [`try=${figure}`];
  const state = preset(data, unknown.length ? "fig5" : figure);
  const controller = words.get("controller") ?? state.controller;
  if (Object.hasOwn(data.controllers, controller)) state.controller = controller;
  else unknown.push(`controller=${controller}`);
  for (const [key, value] of words) {
    if (key === "try" || key === "controller") continue;
    const number = value.trim() === "" ? NaN : Number(value);
    if (data.settings.some((s) => s.key === key) && Number.isFinite(number)) state.changes[key] = number;
    else unknown.push(`${key}=${value}`);
  }
  return { state, unknown };
}

/** The system as an .ssd file with the values in it. @param {Data} data @param {State} state @returns {string} */
export function structureOf(data, state) {
  const { step, values } = runOf(data, state);
  /** @type {Record<string, number|string>} */
  const known = { ...values, step, figure: state.figure };
  return data.controllers[state.controller].structure.replace(/@([^@]+)@/g, (_, name) => String(known[name]));
}
