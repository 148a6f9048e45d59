/**
 * Data of the page: blocks of bytes, JSON, and recorded columns, which are unpacked when they are first shown.
 *
 * @typedef {object} Run
 * @property {string} label  Name of the run.
 * @property {Float64Array} time  Communication points, s.
 * @property {Record<string, Float64Array>} columns  Values by name: one for each row, or two for each bin of rows.
 * @property {Record<string, string>} units
 * @property {Record<string, number>} [bins]  Rows of a bin, by column; a column that is not named has all its rows.
 * @property {string[]} [held]  Sampled components: their row k + 1 holds from time[k] on.
 * @property {Record<string, number[][]>} [phases]  Begin and end, s, of the intervals of each phase.
 * @property {Record<string, any>} [extra]  What the modules of sections need besides.
 * @property {(names: string[]) => Promise<void>} [load]  Unpacks columns into `columns`.
 *
 * @typedef {{bytes: number, low: number, step: number, count: number, data: string}} Packed
 *   A column as `orchestration.report.encoding` writes it.
 */

const SAME_INSTANT = 1e-9; // relative to the larger of 1 s and the time
const NO_NUMBERS = [NaN, Infinity, -Infinity]; // meaning of the last codes of a packed column

/** The text of a block of the page. @param {string} id */
const text = (id) => document.getElementById(id)?.textContent ?? "";

/** The parsed JSON of a block. @param {string} id @returns {any} */
export const json = (id) => JSON.parse(text(id));

/** The bytes of a packed block. @param {string} id */
export const block = (id) => unpacked(text(id));

/** Bytes of a text in base64, which gzip has packed. @param {string} base64 */
async function unpacked(base64) {
  const bytes = Uint8Array.from(atob(base64.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The numbers of a packed column. @param {Packed} packed */
export async function decode({ bytes, low, step, count, data }) {
  const [planes, values, size] = [await unpacked(data), new Float64Array(count), 256 ** bytes];
  let code = 0;
  for (let i = 0; i < count; i += 1) {
    let folded = 0;
    for (let plane = bytes - 1; plane >= 0; plane -= 1) folded = folded * 256 + planes[plane * count + i];
    code = (code + (folded % 2 ? -(folded + 1) / 2 : folded / 2) + size) % size;
    const beyond = code - (size - NO_NUMBERS.length);
    values[i] = beyond < 0 ? low + step * code : NO_NUMBERS[beyond];
  }
  return values;
}

/** A run as Python writes it, with columns that wait to be unpacked. @param {any} stored @returns {Promise<Run>} */
export async function runOf(stored) {
  const { start, step, count } = stored.time;
  const time = stored.time.data ? await decode(stored.time) : Float64Array.from({ length: count }, (_, k) => start + k * step);
  /** @type {Record<string, Float64Array>} */
  const columns = {};
  const load = async (/** @type {string[]} */ wanted) => {
    const missing = wanted.filter((name) => Object.hasOwn(stored.columns, name) && !columns[name]);
    await Promise.all(missing.map(async (name) => (columns[name] = await decode(stored.columns[name]))));
  };
  return { ...stored, time, columns, load };
}

/** The number of the last row that is not after a time. @param {Float64Array} times @param {number} time */
export function rowAt(times, time) {
  const reached = time + SAME_INSTANT * Math.max(1, Math.abs(time));
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= reached) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** By how many rows a column is late: 1 for what a sampled component holds. @param {Run} run @param {string} name */
export const lateness = (run, name) => Number(run.held?.includes(name.split(".", 1)[0]) ?? false);

/** The least and the largest value at a communication point: one number where all rows are stored. */
/** @param {Run} run @param {string} name @param {number} row */
export function valuesAt(run, name, row) {
  const [values, bin] = [run.columns[name] ?? [], run.bins?.[name] ?? 1];
  const place = Math.min(row + lateness(run, name), run.time.length - 1);
  const pair = 2 * Math.floor(place / bin);
  return bin === 1 ? [values[place]] : [...values.slice(pair, pair + 2)].sort((a, b) => a - b);
}
