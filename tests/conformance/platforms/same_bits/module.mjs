// Prints the SHA-256 of all outputs in all rows of a system as WebAssembly:
//
//     node module.mjs FOLDER/NAME.wasm STEPS
//
// FOLDER has what `adaptimp export --as wasm` writes. The hash is of float64, the lowest byte first, row by row.
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const PART = 4096; // steps that are recorded at once
const [path, steps] = process.argv.slice(2);
const stem = path.replace(/\.wasm$/, "");
const { load } = await import(pathToFileURL(`${stem}.mjs`).href);
const { description, create } = await load(readFileSync(path), JSON.parse(readFileSync(`${stem}.json`, "utf8")));
const columns = description.variables.filter((variable) => variable.role === "output").map(({ name }) => name);
const hash = createHash("sha256");

function add(rows, first) {
  const bytes = new DataView(new ArrayBuffer(8 * columns.length));
  for (let k = first; k < rows.time.length; ++k) {
    columns.forEach((name, i) => bytes.setFloat64(8 * i, rows[name][k], true));
    hash.update(new Uint8Array(bytes.buffer));
  }
}

const run = create();
run.initialize();
add(run.run(0, { columns }), 0);
for (let done = 0; done < Number(steps); done += PART) {
  add(run.run(Math.min(PART, Number(steps) - done), { columns }), 1); // row 0 is the last one of the part before
}
process.stdout.write(`${hash.digest("hex")}\n`);
