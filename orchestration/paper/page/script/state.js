/**
 * What the visitor asks for, as numbers of a run, as a link and as a command.
 *
 * @typedef {{key: string, label: string, unit: string, factor: number, high: number,
 *   log: boolean, ticks: boolean, group: string, reason: string,
 *   options: {value: number, label: string, values: Record<string, number>}[]}} Setting
 * @typedef {{caption: string, controller: string, step: number, stop: number, hash: string}} Figure
 * @typedef {{name: string, index: number, role: string, type: string, unit: string}} Variable
 * @typedef {{label: string, structure: string,
 *   description: {variables: Variable[]}}} Controller
 * @typedef {{unit: string, factor: number, text: string}} Criterion
 * @typedef {{figures: Record<string, Figure>, controllers: Record<string, Controller>, settings: Setting[],
 *   fixed: {name: string, value: string, reason: string}[], criteria: Record<string, Criterion>,
 *   claims: {id: string, measured: Record<string, number[]>, touches: number[], holds: number}[],
 *   nodes: import("./formulas.js").Node[],
 *   numbers: {value: number, factor: number, unit: string}[], phases: Record<string, number>,
 *   norms: Record<string, number>,
 *   runs: Record<string, {figure: string, values: Record<string, number>}>, columns: Record<string, string[]>,
 *   starts: Record<string, Record<string, Starts>>, drawn: string[], units: Record<string, string>, held: string[]}} Data
 * @typedef {{given: Record<string, number>, own: Record<string, number>, paths: Record<string, string[]>}} Starts
 *   Start values of a figure with a controller: those of `adaptimp run FIGURE --controller X`, those in which the page
 *   differs, and the variables of each setting
 * @typedef {{figure: string, controller: string, changes: Record<string, number>}} State
 * @typedef {{controller: string, step: number, stop: number, values: Record<string, number>}} Run
 */

const SAMPLING = "sample_time";

/** @param {Data} data @param {State} state */
const startsOf = (data, state) => data.starts[state.figure][state.controller];

/** @param {Data} data @param {State} state @returns {Run} */
export function runOf(data, state) {
  const { given, own, paths } = startsOf(data, state);
  const { step: usual, stop } = data.figures[state.figure];
  /** @type {Record<string, number>} */
  const values = { ...given, ...own };
  const step = state.changes[SAMPLING] ?? usual;
  for (const { key, ticks, options } of data.settings) {
    const asked = state.changes[key];
    if (asked === undefined && !(ticks && SAMPLING in state.changes)) continue;
    const chosen = options.find((option) => option.value === asked);
    for (const path of paths[key]) {
      const value = chosen?.values[path] ?? asked ?? values[path];
      values[path] = !ticks ? value : Math.round(value / step) > 1 ? Math.round(value / step) * step : 0;
    }
  }
  return { controller: state.controller, step, stop, values };
}

/**
 * The value of a setting in a run; undefined if the run does not have it.
 * @param {Data} data @param {State} state @param {Setting} setting
 * @returns {number|undefined}
 */
export function valueOf(data, state, setting) {
  const [asked, paths] = [state.changes[setting.key], startsOf(data, state).paths[setting.key]];
  if (!paths.length) return undefined;
  if (asked !== undefined && !setting.ticks) return asked;
  const { values, step } = runOf(data, state);
  const option = setting.options.find(({ values: of }) => paths.every((path) => of[path] === values[path]));
  return option?.value ?? (setting.ticks ? values[paths[0]] || step : values[paths[0]]);
}

/** The state with all numbers of a figure. @type {(data: Data, figure: string) => State} */
export const preset = (data, figure) => ({ figure, controller: data.figures[figure].controller, changes: {} });

/** The command that gives the same rows. @param {Data} data @param {State} state @returns {string} */
export function commandOf(data, state) {
  const [figure, { given }, { values, step }] = [data.figures[state.figure], startsOf(data, state), runOf(data, state)];
  const changed = Object.keys(values).filter((path) => values[path] !== given[path] && !path.endsWith(SAMPLING));
  const controller = state.controller === figure.controller ? "" : ` --controller ${state.controller}`;
  const sampling = step === figure.step ? "" : ` --sample-time ${step}`;
  const sets = changed.map((path) => ` --set "${path}=${values[path]}"`).join("");
  return `adaptimp run ${state.figure}${controller}${sampling}${sets} --hash`;
}

/** @param {Data} data @param {State} state @returns {string} what follows # in a link */
export function linkOf(data, state) {
  const switched = state.controller === data.figures[state.figure].controller ? {} : { controller: state.controller };
  return new URLSearchParams(/** @type {any} */ ({ try: state.figure, ...switched, ...state.changes })).toString();
}

/**
 * The state of a link; undefined if the link is of another part of the page.
 * @param {Data} data @param {string} text
 * @returns {{state: State, unknown: string[]}|undefined}
 */
export function fromLink(data, text) {
  const words = [...new URLSearchParams(text.replace(/^#/, ""))];
  const { try: figure, controller } = Object.fromEntries(words);
  if (figure === undefined) return undefined;
  const state = preset(data, Object.hasOwn(data.figures, figure) ? figure : "fig5");
  if (Object.hasOwn(data.controllers, controller ?? "")) state.controller = controller;
  const isKnown = (/** @type {string} */ key) => data.settings.some((setting) => setting.key === key);
  for (const [key, value] of words) if (isKnown(key) && value.trim() && Number.isFinite(+value)) state.changes[key] = +value;
  const taken = /** @type {Record<string, string>} */ ({ try: state.figure, controller: state.controller });
  const unknown = words.filter(([key, value]) => !(key in state.changes) && taken[key] !== value);
  return { state, unknown: unknown.map((word) => word.join("=")) };
}

/** The system as an .ssd file with the values in it. @param {Data} data @param {State} state @returns {string} */
export function structureOf(data, state) {
  const { step, values } = runOf(data, state);
  /** @type {Record<string, number|string>} */
  const known = { ...values, step, figure: state.figure };
  return data.controllers[state.controller].structure.replace(/@([^@]+)@/g, (_, name) => String(known[name]));
}
