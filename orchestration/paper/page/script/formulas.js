/**
 * Computes formulas of `orchestration.paper.page.live_formulas`: each part once, when it is first asked for.
 *
 * @typedef {Record<string, Float64Array>} Rows
 * @typedef {number|Float64Array} Value a number, or one for each row; what is computed of columns that begin a row
 *   later has one row less
 * @typedef {[string, ...any[]]} Node an operation and its operands: places of other nodes
 */

/** What an operation makes of the numbers of a row. One function for all of them is what browsers make fast. */
/** @param {string} op @param {number} a @param {number} b @returns {number} a condition is 1 or 0 */
export function compute(op, a, b) {
  switch (op) {
    case "-": return a - b;
    case "*": return a * b;
    case "norm": return Math.sqrt(a * a + b * b);
    case ">": return Number(a > b);
    case ">=": return Number(a >= b);
    case "abs": return Math.abs(a);
    case "+": return a + b;
    case "/": return a / b;
    case "sqrt": return Math.sqrt(a);
    default: throw new Error(`The page cannot compute ${op}.`);
  }
}

/** @type {Record<string, (values: Float64Array) => number>} */
const REDUCE = {
  max: (values) => values.reduce((a, b) => Math.max(a, b), -Infinity),
  min: (values) => values.reduce((a, b) => Math.min(a, b), Infinity),
  mean: (values) => sum(values) / values.length,
  initial: (values) => values[0],
  final: (values) => values[values.length - 1],
};

/**
 * What gives the value at a place; NaN for a reduction of no row.
 * @param {Node[]} nodes @param {(run: string) => Rows} rows @param {(run: string) => Record<string, number>} starts
 * @returns {(place: number) => any} a `Value`
 */
export function valuesOf(nodes, rows, starts) {
  /** @type {Value[]} */
  const found = [];
  const at = (/** @type {number} */ place) => (found[place] ??= computed(...nodes[place]));
  /** @param {string} op @param {any[]} operands @returns {Value} */
  const computed = (op, ...operands) => {
    if (op === "number") return operands[0];
    if (op === "start") return starts(operands[0])[operands[1]];
    if (op === "column") return rows(operands[0])[operands[1]].subarray(operands[2]);
    const [a, b] = /** @type {any[]} */ (operands.map(at));
    if (op === "count") return count(a);
    if (!(op in REDUCE)) return each(op, a, b ?? a);
    const values = b ? a.filter((/** @type {number} */ _, /** @type {number} */ k) => b[k]) : a;
    return values.length ? REDUCE[op](values) : NaN;
  };
  return at;
}

/** @param {string} op @param {Value} a @param {Value} b @returns {Value} */
function each(op, a, b) {
  if (typeof a === "number" && typeof b === "number") return compute(op, a, b);
  const size = Math.min(...[a, b].map((of) => (typeof of === "number" ? Infinity : of.length)));
  const [left, right] = [a, b].map((of) => (typeof of === "number" ? new Float64Array(size).fill(of) : of));
  const values = new Float64Array(size);
  for (let k = 0; k < size; k += 1) values[k] = compute(op, left[k], right[k]);
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

/** How often a condition has begun to hold. @param {Float64Array} condition */
function count(condition) {
  let begun = 0;
  return condition.map((holds, k) => (begun += Number(holds && !condition[k - 1])));
}
