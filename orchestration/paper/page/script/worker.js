/**
 * The worker of the live page. Of each kind it does the newest work that was asked for, and drops what is out of date.
 *
 * @typedef {import("./state.js").State} State
 * @typedef {{kind: "show"|"claims"|"hash"|"csv", state: State}} Request
 */
import { answer, evidence } from "./claims.js";
import { Formulas } from "./formulas.js";
import { Loop } from "./loop.js";
import { runOf } from "./state.js";

/** @type {Promise<Loop>} */
let loop;
/** @type {Map<string, Request>} */
const waiting = new Map();
let busy = false;

addEventListener("message", async ({ data: said }) => {
  if (said.data) loop = Loop.of(said.data, said.modules, /** @type {any} */ (self).load);
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
    const formulas = new Formulas(data.nodes, () => rows, () => run.values);
    const numbers = data.numbers.map(({ value }) => formulas.at(value));
    const phases = Object.fromEntries(Object.entries(data.phases).map(([name, on]) => [name, spans(rows.time, formulas.at(on))]));
    for (const [name, place] of Object.entries(data.norms)) rows[name] = formulas.at(place);
    const shown = { ...request, rows, numbers, phases, milliseconds: performance.now() - began };
    postMessage(shown, { transfer: Object.values(rows).map((column) => column.buffer) });
  } else if (request.kind === "hash") postMessage({ ...request, hash: await of.hash(run) });
  else if (request.kind === "csv") postMessage({ ...request, csv: of.csv(run) });
  else {
    const formulas = evidence(data, request.state, (one, columns) => of.rows(one, columns));
    for (const claim of data.claims) {
      postMessage({ ...request, answer: answer(data, formulas, claim), milliseconds: performance.now() - began });
      await arrived();
      if (waiting.has("claims")) return;
    }
  }
}

/** Begin and end, s, of each interval in which a condition holds. @param {Float64Array} time @param {Float64Array} on */
function spans(time, on) {
  /** @type {number[][]} */
  const found = [];
  on.forEach((now, k) => {
    if (now && !on[k - 1]) found.push([time[k], time[k]]);
    else if (now) found[found.length - 1][1] = time[k];
  });
  return found;
}
