/**
 * Measures of runs, as orchestration/paper/measure.py has them. Every controller ticks at every row here, so the value of
 * a sampled column at time[k] stands in row k + 1.
 *
 * @typedef {Record<string, Float64Array>} Rows
 * @typedef {{first: number, last: number, enter: number[], leave: number[], share: number, phases: number, peak: number}}
 *   Contact times in s, points in m, force in N
 */

/** The columns that measures need. */
export const MEASURED = [
  ...["plant.F_ext", "plant.x", "controller.e", "controller.tau_cmd"].flatMap((name) => [`${name}[1]`, `${name}[2]`]),
  "controller.p_hat[2]",
];
export const REFERENCE = ["controller.x_t[1]", "controller.x_t[2]", "trajectory.x_v[1]", "trajectory.x_v[2]"];

/** @param {Rows} rows @param {string} name @param {number} [from] first row @returns {Float64Array} */
export function norms(rows, name, from = 0) {
  const [x, y] = [1, 2].map((i) => rows[`${name}[${i}]`].subarray(from));
  return x.map((value, k) => Math.sqrt(value * value + y[k] * y[k]));
}

/** @param {ArrayLike<number>} values @param {(k: number) => boolean} [where] @returns {number} NaN of none */
export function largest(values, where = () => true) {
  let found = -Infinity;
  for (let k = 0; k < values.length; ++k) if (where(k) && values[k] > found) found = values[k];
  return found === -Infinity ? NaN : found;
}

/** A sum with the error of each addition carried along (Neumaier). @param {Iterable<number>} values */
export function sum(values) {
  let [total, lost] = [0, 0];
  for (const value of values) {
    const next = total + value;
    lost += Math.abs(total) >= Math.abs(value) ? total - next + value : value - next + total;
    total = next;
  }
  return total + lost;
}

/** @param {number[]} values */
const mean = (values) => sum(values) / values.length;

/** @param {ArrayLike<number>} a @param {ArrayLike<number>} b */
export const distance = (a, b) => Math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2);

/** @param {Rows} rows @returns {Contact} */
export function contact(rows) {
  const force = norms(rows, "plant.F_ext");
  const first = force.findIndex((f) => f > 0);
  if (first < 0) throw new Error("the tip never touches the wall");
  const last = force.findLastIndex((f) => f > 0);
  let [touching, phases] = [0, 0];
  for (let k = first; k <= last; ++k) {
    if (force[k] > 0) ++touching;
    if (force[k] > 0 && !(k > 0 && force[k - 1] > 0)) ++phases;
  }
  /** @param {number} k */
  const tip = (k) => [rows["plant.x[1]"][k], rows["plant.x[2]"][k]];
  const { time } = rows;
  const share = touching / (last - first + 1);
  return { first: time[first], last: time[last], enter: tip(first), leave: tip(last), share, phases, peak: largest(force) };
}

/** Mean force from the second touch on, N. @param {Rows} rows */
export function steadyForce(rows) {
  const force = [...norms(rows, "plant.F_ext")];
  const begins = force.flatMap((f, k) => (f > 0 && !(k > 0 && force[k - 1] > 0) ? [k] : []));
  return mean(force.slice(begins[Math.min(1, begins.length - 1)]).filter((f) => f > 0));
}

/** Largest |e| before the first contact, m, or of the whole run. @param {Rows} rows */
export function freeError(rows) {
  const touch = norms(rows, "plant.F_ext").findIndex((f) => f > 0);
  const first = touch < 0 ? Infinity : rows.time[touch];
  return largest(norms(rows, "controller.e", 1), (k) => rows.time[k] < first);
}

/** @param {Rows} rows @param {number[]} start */
export const endDistance = (rows, start) => distance([rows["plant.x[1]"].at(-1) ?? NaN, rows["plant.x[2]"].at(-1) ?? NaN], start);

/** |x_t - x_v| at the ticks, m. @param {Rows} rows @returns {Float64Array} */
export function referenceDistance(rows) {
  const [x, y, v, w] = REFERENCE.map((name) => rows[name].subarray(1));
  return x.map((value, k) => distance([value, y[k]], [v[k], w[k]]));
}

/**
 * A run with adaptation in numbers, as `Summary` of measure.py.
 * @param {Rows} rows @param {number} m2 mass of the arm, kg @param {Rows} ideal
 * @param {{settled: number, recovered: number, start: number[]}} numbers
 */
export function summary(rows, m2, ideal, { settled, recovered, start }) {
  const touch = contact(rows);
  const { time } = rows;
  const e = norms(rows, "controller.e", 1);
  const estimate = rows["controller.p_hat[2]"].subarray(1);
  const error = estimate.map((value) => Math.abs(value - m2));
  /** @param {number} k */
  const before = (k) => time[k] < touch.first, during = (k) => time[k] >= touch.first && time[k] <= touch.last;
  const off = error.findLastIndex((value, k) => before(k) && value > settled);
  const still = error.findLastIndex((value, k) => time[k] > touch.last && value > recovered);
  const at = error.findLastIndex((_, k) => before(k));
  const torque = [1, 2].map((i) => largest(rows[`controller.tau_cmd[${i}]`].subarray(1).map(Math.abs)));
  return {
    m2Settled: off < 0 ? 0 : time[off],
    m2AtContact: at < 0 ? NaN : error[at],
    m2InContact: largest(error, during),
    m2Fluctuation: largest(estimate, during) + largest(estimate.map((value) => -value), during),
    m2Recovery: still < 0 ? 0 : time[still] - touch.last,
    torque,
    eStart: largest(e, before),
    eFree: largest(e, (k) => before(k) && time[k] > touch.first / 2),
    eContact: largest(e, during),
    eMax: largest(e),
    forceError: forceError(rows, ideal),
    end: endDistance(rows, start),
  };
}

/** Rms difference of the force from that of the ideal run while either touches, N. @param {Rows} rows @param {Rows} ideal */
function forceError(rows, ideal) {
  const [fx, fy, gx, gy] = [rows, ideal].flatMap((of) => [of["plant.F_ext[1]"], of["plant.F_ext[2]"]]);
  const [f, g] = [norms(rows, "plant.F_ext"), norms(ideal, "plant.F_ext")];
  const squares = [];
  for (let k = 0; k < f.length; ++k) if (f[k] > 0 || g[k] > 0) squares.push((fx[k] - gx[k]) ** 2 + (fy[k] - gy[k]) ** 2);
  return Math.sqrt(mean(squares));
}

const MOST_ROWS = 20001;
const SAMPLED = /^(trajectory|sensor|controller|actuator)\./;

/** Rows to draw: each n-th one, with the values of a sampled column at the time of their tick. @param {Rows} rows @returns {Rows} */
export function thinned(rows) {
  const all = rows.time.length;
  const every = Math.ceil((all - 1) / (MOST_ROWS - 1));
  /** @param {string} name @param {Float64Array} column */
  const some = (name, column) => {
    const late = SAMPLED.test(name) ? 1 : 0;
    const kept = new Float64Array(Math.floor((all - 1) / every) + 1);
    return kept.map((_, k) => column[Math.min(k * every + late, all - 1)]);
  };
  return Object.fromEntries(Object.entries(rows).map(([name, column]) => [name, some(name, column)]));
}

/** The numbers of a run that are looked at first: name, value and unit. @param {Rows} rows @returns {[string, number, string][]} */
export function numbersOf(rows) {
  const touches = norms(rows, "plant.F_ext").some((f) => f > 0);
  const limited = [1, 2].map((joint) => rows[`actuator.saturated[${joint}]`].subarray(1));
  const share = limited[0].filter((value, k) => value > 0 || limited[1][k] > 0).length / limited[0].length;
  /** @type {[string, number, string][]} */
  const found = [["Largest |e| in free motion until the contact", 1e3 * freeError(rows), "mm"]];
  if (touches) {
    const { first, last, peak } = contact(rows);
    const e = norms(rows, "controller.e", 1);
    const worst = largest(e, (k) => rows.time[k] >= first && rows.time[k] <= last);
    found.push(["Contact from", first, "s"], ["Contact until", last, "s"], ["Peak force", peak, "N"]);
    found.push(["Largest |e| in contact", 1e3 * worst, "mm"]);
  }
  found.push(["Estimate of m2 at the end", rows["controller.p_hat[2]"].at(-1) ?? NaN, "kg"]);
  found.push(["Ticks with a saturated actuator", 100 * share, "%"]);
  return found;
}
