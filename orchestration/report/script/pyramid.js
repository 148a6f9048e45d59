/** Curves thinned to what a screen shows: the least and the largest value of bins of rows, at several sizes of bins. */

const WIDER = 4; // by which the bins of a level hold more rows than those of the level below
const FEW = 32; // values that need no coarser level

/** @typedef {{bin: number, values: Float64Array}} Level  One value for each row, or two for each bin as they follow. */

/** All levels of a curve. @param {Float64Array} values @param {number} [bin]  Rows of a bin of the values. */
export function pyramid(values, bin = 1) {
  /** @type {Level[]} */
  const levels = [{ bin, values }];
  for (let [below, of] = [values, bin === 1 ? WIDER : 2 * WIDER]; below.length > FEW; of = 2 * WIDER) {
    below = coarser(below, of);
    levels.push({ bin: levels[levels.length - 1].bin * WIDER, values: below });
  }
  return levels;
}

/** The finest level with at most so many points between two rows. */
/** @param {Level[]} levels @param {number} rows  Number of rows that are shown. @param {number} most */
export function level(levels, rows, most) {
  return levels.find(({ bin }) => (bin === 1 ? rows : (2 * rows) / bin) <= most) ?? levels[levels.length - 1];
}

/** The least and the largest of so many values each; what is not a number is left out. */
/** @param {Float64Array} values @param {number} of */
function coarser(values, of) {
  const joined = new Float64Array(2 * Math.ceil(values.length / of)).fill(NaN);
  for (let bin = 0; 2 * bin < joined.length; bin += 1) {
    let [least, most] = [-1, -1];
    for (let i = bin * of; i < Math.min((bin + 1) * of, values.length); i += 1) {
      if (!(values[i] >= values[least])) least = Number.isNaN(values[i]) ? least : i;
      if (!(values[i] <= values[most])) most = Number.isNaN(values[i]) ? most : i;
    }
    if (least >= 0) [joined[2 * bin], joined[2 * bin + 1]] = [values[Math.min(least, most)], values[Math.max(least, most)]];
  }
  return joined;
}
