// Times the steps of a system as WebAssembly in node:
//
//     node tests/benchmarks/wasm_speed.mjs FOLDER/fig5.wasm [STEPS] [REPEATS]
//
// makes STEPS (100000) steps from the start, REPEATS (5) times after one that does not count, and prints JSON:
// seconds of each repeat, and the time of a step in ns from the shortest. FOLDER has what `--as wasm` writes.
import { readFileSync } from "node:fs";
import { performance } from "node:perf_hooks";
import { pathToFileURL } from "node:url";

const [path, steps = 100000, repeats = 5] = process.argv.slice(2);
const stem = path.replace(/\.wasm$/, "");
const { load } = await import(pathToFileURL(`${stem}.mjs`).href);
const system = await load(readFileSync(path), JSON.parse(readFileSync(`${stem}.json`, "utf8")));
const run = system.create();
const seconds = [];
for (let i = 0; i <= Number(repeats); ++i) {
  run.reset();
  run.initialize();
  const started = performance.now();
  run.run(Number(steps));
  seconds.push((performance.now() - started) / 1e3);
}
seconds.shift();
const nanoseconds = (1e9 * Math.min(...seconds)) / Number(steps);
process.stdout.write(`${JSON.stringify({ node: process.version, steps: Number(steps), seconds, nanoseconds })}\n`);
