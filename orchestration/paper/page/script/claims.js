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
import { Formulas, compute } from "./formulas.js";
import { preset, runOf } from "./state.js";

/** The runs that claims need, each made when it is first asked for; a failure is kept as well. */
export class Evidence {
  /** @param {Data} data @param {State} state @param {(run: Run, columns: string[]) => Rows} make */
  constructor(data, state, make) {
    this.data = data;
    /** @type {Map<string, Rows|Error>} */
    const found = new Map();
    const run = (/** @type {string} */ name) => {
      const { figure, values } = data.runs[name];
      const changed = runOf(data, { ...preset(data, figure), changes: state.changes });
      return { ...changed, values: { ...changed.values, ...values } };
    };
    const rows = (/** @type {string} */ name) => {
      try {
        if (!found.has(name)) found.set(name, make(run(name), data.columns[name]));
      } catch (error) {
        found.set(name, new Error(`the run ${name} fails: ${error instanceof Error ? error.message : error}`));
      }
      const one = found.get(name);
      if (one instanceof Error) throw one;
      return /** @type {Rows} */ (one);
    };
    this.formulas = new Formulas(data.nodes, rows, (name) => run(name).values);
  }
}

/** @param {Evidence} from @param {string} id of a claim @returns {Answer} */
export function answer({ data, formulas }, id) {
  const { measured, touches } = data.claims.find((claim) => claim.id === id) ?? { measured: {}, touches: [] };
  try {
    if (touches.some((place) => Number.isNaN(formulas.at(place)))) throw new Error("the tip never touches the wall");
    const found = Object.entries(measured).map(([name, places]) => [name, places.map((place) => formulas.at(place))]);
    const values = /** @type {Record<string, number[]>} */ (Object.fromEntries(found));
    const met = Object.entries(values).map(([name, numbers]) => {
      const { comparison, limit } = data.criteria[name];
      return numbers.every((value) => compute(comparison, value, limit));
    });
    return { id, holds: met.every(Boolean), values, why: "" };
  } catch (error) {
    return { id, holds: null, values: {}, why: error instanceof Error ? error.message : String(error) };
  }
}
