/**
 * Judges the claims C1 to C10 for the numbers of the form, with one seed of the noise.
 *
 * @typedef {import("./state.js").Data} Data
 * @typedef {import("./state.js").State} State
 * @typedef {import("./state.js").Run} Run
 * @typedef {import("./formulas.js").Rows} Rows
 * @typedef {{id: string, holds: boolean|null, values: Record<string, number[]>, why: string}} Answer
 *   `holds` is null if the claim cannot be judged, and `why` says why
 */
import { valuesOf } from "./formulas.js";
import { preset, runOf } from "./state.js";

/**
 * What gives the values of formulas over the runs that claims need, each made when it is first asked for.
 * @param {Data} data @param {State} state @param {(run: Run, columns: string[]) => Rows} make
 */
export function evidence(data, state, make) {
  /** @type {Record<string, Rows>} */
  const found = {};
  const run = (/** @type {string} */ name) => {
    const { figure, values } = data.runs[name];
    const changed = runOf(data, { ...preset(data, figure), changes: state.changes });
    return { ...changed, values: { ...changed.values, ...values } };
  };
  const rows = (/** @type {string} */ name) => {
    try {
      return (found[name] ??= make(run(name), data.columns[name]));
    } catch (error) {
      throw new Error(`the run ${name} fails: ${/** @type {Error} */ (error).message}`);
    }
  };
  return valuesOf(data.nodes, rows, (name) => run(name).values);
}

/** @param {(place: number) => any} at @param {Data["claims"][0]} claim @returns {Answer} */
export function answer(at, { id, measured, touches, holds }) {
  try {
    if (touches.some((place) => Number.isNaN(at(place)))) throw new Error("the tip never touches the wall");
    const values = Object.fromEntries(Object.entries(measured).map(([name, places]) => [name, places.map(at)]));
    return { id, holds: at(holds) === 1, values, why: "" };
  } catch (error) {
    return { id, holds: null, values: {}, why: /** @type {Error} */ (error).message };
  }
}
