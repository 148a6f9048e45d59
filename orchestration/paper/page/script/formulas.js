/**
 * Computes formulas of `orchestration.paper.page.live_formulas`: each part once, when it is first asked for.
 *
 * @typedef {Record<string, Float64Array>} Rows
 * @typedef {number|Float64Array|Uint8Array} Value a number, or one for each row; what is computed of columns that begin a row
 *   later has one row less
 * @typedef {[string, ...any[]]} Node an operation and its operands: places of other nodes
 */

/** @type {Record<string, () => (a: number, b: number) => number|boolean>} a count has a memory, so each is made anew */
export const EACH = {
  "+": () => (a, b) => a + b,
  "-": () => (a, b) => a - b,
  "*": () => (a, b) => a * b,
  "/": () => (a, b) => a / b,
  "<": () => (a, b) => a < b,
  "<=": () => (a, b) => a <= b,
  ">": () => (a, b) => a > b,
  ">=": () => (a, b) => a >= b,
  and: () => (a, b) => a && b,
  or: () => (a, b) => a || b,
  not: () => (a) => !a,
  abs: () => Math.abs,
  sqrt: () => Math.sqrt,
  norm: () => (a, b) => Math.sqrt(a * a + b * b),
  count: () => {
    let [begun, before] = [0, 0];
    return (a) => ((begun += Number(a && !before)), (before = a), begun);
  },
};
const CONDITIONS = ["<", "<=", ">", ">=", "and", "or", "not"];

/** @type {Record<string, (values: Float64Array) => number>} */
const REDUCE = {
  max: (values) => values.reduce((a, b) => Math.max(a, b), -Infinity),
  min: (values) => values.reduce((a, b) => Math.min(a, b), Infinity),
  mean: (values) => sum(values) / values.length,
  rms: (values) => Math.sqrt(sum(values.map((value) => value * value)) / values.length),
  initial: (values) => values[0],
  final: (values) => values[values.length - 1],
};

export class Formulas {
  /** @param {Node[]} nodes @param {(run: string) => Rows} rows @param {(run: string) => Record<string, number>} starts */
  constructor(nodes, rows, starts) {
    this.nodes = nodes;
    this.rows = rows;
    this.starts = starts;
    /** @type {Value[]} */
    this.found = [];
  }

  /** @param {number} place @returns {any} a `Value`; NaN for a reduction of no row */
  at(place) {
    return (this.found[place] ??= this.#computed(...this.nodes[place]));
  }

  /** @param {string} op @param {any[]} operands @returns {Value} */
  #computed(op, ...operands) {
    if (op === "number") return operands[0];
    if (op === "start") return this.starts(operands[0])[operands[1]];
    if (op === "column") return this.rows(operands[0])[operands[1]].subarray(operands[2]);
    const [a, b] = operands.map((place) => this.at(place));
    if (!(op in REDUCE)) return each(op, a, b ?? a);
    const chosen = b ? a.filter((/** @type {number} */ _, /** @type {number} */ k) => b[k]) : a;
    return chosen.length ? REDUCE[op](chosen) : NaN;
  }
}

/** @param {string} op @param {Value} a @param {Value} b @returns {Value} */
function each(op, a, b) {
  const [compute, sizes] = [EACH[op](), [a, b].flatMap((of) => (typeof of === "number" ? [] : [of.length]))];
  if (typeof a === "number" && typeof b === "number") return Number(compute(a, b));
  const size = Math.min(...sizes);
  const [left, right] = [a, b].map((of) => (typeof of === "number" ? new Float64Array(size).fill(of) : of));
  const values = new (CONDITIONS.includes(op) ? Uint8Array : Float64Array)(size);
  for (let k = 0; k < size; k += 1) values[k] = Number(compute(left[k], right[k]));
  return values;
}

/** A sum with the error of each addition carried along (Kahan). @param {Float64Array} values */
function sum(values) {
  let [total, lost] = [0, 0];
  for (const value of values) {
    const next = total + (value - lost);
    lost = next - total - (value - lost);
    total = next;
  }
  return total;
}
