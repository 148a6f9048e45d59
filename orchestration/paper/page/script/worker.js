/**
 * The worker of the live page. It makes the newest run that was asked for, and drops what is out of date.
 *
 * @typedef {import("./state.js").State} State
 * @typedef {{number: number, kind: "show"|"claims"|"hash"|"csv", state: State}} Request
 */
import { Evidence, answer } from "./claims.js";
import { Loop } from "./loop.js";
import { MEASURED, REFERENCE } from "./measures.js";
import { runOf } from "./state.js";

/** Columns that the page draws. */
const SHOWN = [...MEASURED, ...REFERENCE, "plant.q[1]", "plant.q[2]", "actuator.saturated[1]", "actuator.saturated[2]"];

/** @type {Promise<Loop>} */
let loop;
/** @type {Request|undefined} */
let newest;
let busy = false;

addEventListener("message", async ({ data: said }) => {
  if (said.data) {
    loop = Loop.of(said.data);
    return;
  }
  newest = said;
  if (busy) return;
  busy = true;
  while (newest) {
    const request = newest;
    newest = undefined;
    try {
      await serve(await loop, request);
    } catch (error) {
      postMessage({ ...request, error: error instanceof Error ? error.message : String(error) });
    }
    await arrived();
  }
  busy = false;
});

/** Lets messages in that have arrived meanwhile. */
const arrived = () => new Promise((resolve) => setTimeout(resolve, 0));

/** @param {Loop} of @param {Request} request */
async function serve(of, request) {
  const { data } = of;
  const began = performance.now();
  const run = runOf(data, request.state);
  if (request.kind === "show") {
    const rows = of.rows(run, SHOWN);
    postMessage({ ...request, rows, milliseconds: performance.now() - began }, Object.values(rows).map((c) => c.buffer));
  } else if (request.kind === "hash") postMessage({ ...request, hash: await of.hash(run) });
  else if (request.kind === "csv") postMessage({ ...request, csv: of.csv(run) });
  else {
    const evidence = new Evidence(data, request.state, (one, columns) => of.rows(one, columns));
    for (const { id } of data.claims) {
      postMessage({ ...request, answer: answer(evidence, id), milliseconds: performance.now() - began });
      await arrived();
      if (newest) return;
    }
  }
}
