/**
 * Runs the paper's loop as WebAssembly, and gives its rows, its hash and its file.
 *
 * @typedef {import("./state.js").Data} Data
 * @typedef {import("./state.js").Run} Run
 * @typedef {import("./formulas.js").Rows} Rows
 */
const PART = 10000; // steps of which all outputs are kept at once

/** @typedef {Awaited<ReturnType<typeof loopOf>>} Loop */

/**
 * @param {Data} data @param {Record<string, BufferSource>} modules of WebAssembly, by controller
 * @param {(module: BufferSource, description: object) => Promise<any>} load of the host of modules
 */
export async function loopOf(data, modules, load) {
  const names = Object.keys(data.controllers);
  const loaded = names.map(async (name) => [name, await load(modules[name], data.controllers[name].description)]);
  const systems = Object.fromEntries(await Promise.all(loaded));

  /** The rows part by part, all outputs unless columns are named. */
  /** @param {Run} run @param {string[]} [columns] @param {number} [size] steps of a part @returns {Generator<Rows>} */
  function* parts(run, columns = outputs(data, run.controller), size = PART) {
    const [started, all] = [systems[run.controller].create(), Math.round(run.stop / run.step)];
    try {
      started.setStep(run.step);
      started.set(run.values);
      started.initialize();
      for (let done = 0; done < all; done += size) {
        const rows = started.run(Math.min(size, all - done), { columns });
        yield done ? Object.fromEntries(Object.entries(rows).map(([name, column]) => [name, column.subarray(1)])) : rows;
      }
    } finally {
      started.free();
    }
  }

  /** Every row of some columns. @param {Run} run @param {string[]} columns @returns {Rows} */
  const rowsOf = (run, columns) => [...parts(run, columns, Infinity)][0];

  /** SHA-256 of all rows, as `adaptimp run --hash` says it. @param {Run} run @returns {Promise<string>} */
  async function hash(run) {
    const columns = outputs(data, run.controller);
    const all = new Float64Array((Math.round(run.stop / run.step) + 1) * columns.length);
    let row = 0;
    for (const rows of parts(run)) {
      columns.forEach((name, j) => rows[name].forEach((value, k) => (all[(row + k) * columns.length + j] = value)));
      row += rows.time.length;
    }
    const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", all));
    return [...digest].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  }

  /** The file that `adaptimp run --out F.csv` writes. @param {Run} run @returns {Blob} */
  function csv(run) {
    const texts = [["time", ...outputs(data, run.controller)].map((name) => `"${name}"`).join(",")];
    for (const rows of parts(run)) {
      const columns = Object.values(rows);
      texts.push(Array.from(rows.time, (_, k) => columns.map((column) => decimal(column[k])).join(",")).join("\n"));
    }
    return new Blob(texts.flatMap((text) => [text, "\n"]), { type: "text/csv" });
  }
  return { data, rows: rowsOf, hash, csv };
}

/** @param {Data} data @param {string} controller @returns {string[]} */
const outputs = (data, controller) =>
  data.controllers[controller].description.variables.filter((v) => v.role === "output").map((v) => v.name);

/** A number with as few digits as tell it from all others, in the form of the CSV files. @param {number} value */
export function decimal(value) {
  if (Object.is(value, -0)) return "-0";
  if (Number.isNaN(value)) return "nan";
  return Math.abs(value) >= 1e10 ? value.toExponential().replace("Infinity", "inf") : String(value);
}
