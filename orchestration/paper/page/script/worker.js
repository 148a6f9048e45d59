/**
 * The worker of the live page. Of each kind it does the newest work that was asked for, and drops what is out of date.
 *
 * @typedef {import("./state.js").State} State
 * @typedef {import("./loop.js").Loop} Loop
 * @typedef {{kind: "show"|"claims"|"hash"|"csv", state: State}} Request
 */
import { answer, evidence } from "./claims.js";
import { valuesOf } from "./formulas.js";
import { loopOf } from "./loop.js";
import { runOf } from "./state.js";

/** @type {Promise<Loop>} */
let loop;
/** @type {Map<string, Request>} */
const waiting = new Map();
let busy = false;

addEventListener("message", async ({ data: said }) => {
  if (said.data) loop = loopOf(said.data, said.modules, /** @type {any} */ (self).load);
  else waiting.set(said.kind, said);
  if (busy) return;
  busy = true;
  for (const [kind, request] of waiting) {
    waiting.delete(kind);
    try {
      await serve(await loop, request);
    } catch (error) {
      postMessage({ ...request, error: /** @type {Error} */ (error).message });
    }
    await arrived();
  }
  busy = false;
});

/** Lets messages in that have arrived meanwhile. */
const arrived = () => new Promise((resolve) => setTimeout(resolve, 0));

/** @param {Loop} of @param {Request} request */
async function serve(of, request) {
  const [{ data }, began] = [of, performance.now()];
  const run = runOf(data, request.state);
  if (request.kind === "show") {
    const rows = of.rows(run, data.drawn);
    const at = valuesOf(data.nodes, () => rows, () => run.values);
    const numbers = data.numbers.map(({ value }) => at(value));
    const phases = Object.fromEntries(Object.entries(data.phases).map(([name, on]) => [name, spans(rows.time, at(on))]));
    for (const [name, place] of Object.entries(data.norms)) rows[name] = at(place);
    const shown = { ...request, rows, numbers, phases, milliseconds: performance.now() - began };
    postMessage(shown, { transfer: Object.values(rows).map((column) => column.buffer) });
  } else if (request.kind === "hash") postMessage({ ...request, hash: await of.hash(run) });
  else if (request.kind === "csv") postMessage({ ...request, csv: of.csv(run) });
  else {
    const at = evidence(data, request.state, (one, columns) => of.rows(one, columns));
    for (const claim of data.claims) {
      postMessage({ ...request, answer: answer(at, claim), milliseconds: performance.now() - began });
      await arrived();
      if (waiting.has("claims")) return;
    }
  }
}

/** Begin and end, s, of each interval in which a condition holds. @param {Float64Array} time @param {Float64Array} on */
function spans(time, on) {
  const [begins, ends] = [-1, 1].map((side) => time.filter((_, k) => on[k] && !on[k + side]));
  return Array.from(begins, (begin, i) => [begin, ends[i]]);
}
