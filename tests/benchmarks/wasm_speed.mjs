// Times the steps of a system as WebAssembly in node:
//
//     node tests/benchmarks/wasm_speed.mjs FOLDER/fig5.wasm [STEPS] [REPEATS] [PIECE]
//
// makes STEPS (100000) steps from the start, PIECE (all) of them in a call, REPEATS (5) times after one that does not
// count, and prints JSON: the seconds of each piece of each repeat, and the time of a step in ns from the shortest
// repeat. FOLDER has what `--as wasm` writes.
import { readFileSync } from "node:fs";
import { performance } from "node:perf_hooks";
import { pathToFileURL } from "node:url";

const [path, ...numbers] = process.argv.slice(2);
const [steps = 100000, repeats = 5, piece = steps] = numbers.map(Number);
const stem = path.replace(/\.wasm$/, "");
const { load } = await import(pathToFileURL(`${stem}.mjs`).href);
const system = await load(readFileSync(path), JSON.parse(readFileSync(`${stem}.json`, "utf8")));
const run = system.create();

function repeat() {
  const seconds = [];
  run.reset();
  run.initialize();
  for (let done = 0; done < steps; done += piece) {
    const started = performance.now();
    run.run(Math.min(piece, steps - done));
    seconds.push((performance.now() - started) / 1e3);
  }
  return seconds;
}

repeat();
const seconds = Array.from({ length: repeats }, repeat);
const sum = (pieces) => pieces.reduce((a, b) => a + b);
const nanoseconds = (1e9 * Math.min(...seconds.map(sum))) / steps;
process.stdout.write(`${JSON.stringify({ node: process.version, steps, seconds, nanoseconds })}\n`);
