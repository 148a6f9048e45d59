/**
 * Runs the paper's loop as WebAssembly, and gives its rows, its hash and its file.
 *
 * @typedef {import("./state.js").Data} Data
 * @typedef {import("./state.js").Run} Run
 * @typedef {import("./formulas.js").Rows} Rows
 */
const PART = 10000; // steps of which all outputs are kept at once

export class Loop {
  /** @param {Data} data @param {Record<string, any>} systems by controller */
  constructor(data, systems) {
    this.data = data;
    this.systems = systems;
  }

  /**
   * @param {Data} data @param {Record<string, BufferSource>} modules of WebAssembly, by controller
   * @param {(module: BufferSource, description: object) => Promise<any>} load of the host of modules
   */
  static async of(data, modules, load) {
    const names = Object.keys(data.controllers);
    const loaded = names.map(async (name) => [name, await load(modules[name], data.controllers[name].description)]);
    return new Loop(data, Object.fromEntries(await Promise.all(loaded)));
  }

  /** Every row of some columns. @param {Run} run @param {string[]} columns @returns {Rows} */
  rows(run, columns) {
    const [rows] = this.parts(run, columns, Infinity);
    return rows;
  }

  /** The rows part by part, all outputs unless columns are named. */
  /** @param {Run} run @param {string[]} [columns] @param {number} [size] steps of a part @returns {Generator<Rows>} */
  *parts(run, columns = outputs(this.data, run.controller), size = PART) {
    const [started, all] = [this.systems[run.controller].create(), Math.round(run.stop / run.step)];
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

  /** SHA-256 of all rows, as `adaptimp run --hash` says it. @param {Run} run @returns {Promise<string>} */
  async hash(run) {
    const names = outputs(this.data, run.controller);
    const all = new Float64Array((Math.round(run.stop / run.step) + 1) * names.length);
    let row = 0;
    for (const rows of this.parts(run)) {
      names.forEach((name, j) => rows[name].forEach((value, k) => (all[(row + k) * names.length + j] = value)));
      row += rows.time.length;
    }
    const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", all));
    return [...digest].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  }

  /** The file that `adaptimp run --out F.csv` writes. @param {Run} run @returns {Blob} */
  csv(run) {
    const parts = [];
    for (const rows of this.parts(run)) {
      const columns = Object.values(rows);
      if (!parts.length) parts.push(`${Object.keys(rows).map((name) => `"${name}"`).join(",")}\n`);
      const line = (/** @type {number} */ k) => columns.map((column) => decimal(column[k])).join(",");
      parts.push(`${Array.from(rows.time, (_, k) => line(k)).join("\n")}\n`);
    }
    return new Blob(parts, { type: "text/csv" });
  }
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
