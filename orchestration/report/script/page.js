/** Starts the page: unpacks Bokeh and the runs, draws the panels, and starts the modules of further sections. */

import { connectBoxes, connectChoice, connectZoom } from "./choice.js";
import { connectPlayer, Cursor } from "./cursor.js";
import { block, json, runOf } from "./data.js";
import { Plots } from "./plots.js";
import { connectTheme } from "./theme.js";

const MOST_RUNS = 2; // of those that a page offers

/**
 * What the module of a section gets.
 *
 * @typedef {import("./data.js").Run} Run
 * @typedef {object} Context
 * @property {Run[]} runs  The recorded runs that the page shows at first.
 * @property {Cursor} cursor
 * @property {(runs: Run[]) => Promise<void>} showRuns  Shows runs in panels and player, and tells ``runs`` to the document.
 */

/** @param {((context: Context) => void | Promise<void>)[]} modules */
export async function start(modules) {
  const element = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));
  connectTheme(element("theme"));
  const script = document.createElement("script");
  script.textContent = new TextDecoder().decode(await block("bokeh"));
  document.head.append(script);
  const [cursor, stored] = [new Cursor(), json("runs")];
  const plots = new Plots(element("panels"), cursor, stored.panels, element("thinned"));
  const runs = await Promise.all(stored.runs.map(runOf));
  const showRuns = async (/** @type {Run[]} */ shown) => {
    const times = shown.flatMap(({ time }) => (time.length ? [time[0], time[time.length - 1]] : []));
    [cursor.begin, cursor.end] = times.length ? [Math.min(...times), Math.max(...times)] : [0, 1];
    cursor.zoom(cursor.begin, cursor.end);
    await plots.showRuns(shown);
    if (plots.runs !== shown) return;
    const boxes = element("runs-shown")?.querySelectorAll("input") ?? []; // a run of the live part has none
    for (const box of boxes) box.checked = shown.some(({ label }) => label === box.value);
    document.dispatchEvent(new CustomEvent("runs", { detail: shown }));
    cursor.set(cursor.time);
  };
  const first = stored.shown.map((/** @type {number} */ place) => runs[place]);
  for (const begin of modules) await begin({ runs: first, cursor, showRuns });
  connectPlayer(element("player"), cursor);
  connectChoice(element("choice"), plots, stored.panels);
  connectBoxes(element("runs-shown"), MOST_RUNS, (labels) => showRuns(runs.filter(({ label }) => labels.includes(label))));
  if (stored.difference) {
    const differences = new Plots(element("difference-panels"), cursor, stored.difference.panels);
    await differences.showRuns([await runOf(stored.difference.run)]);
  }
  connectZoom(element("zoom"), cursor);
  if (!plots.runs.length) await showRuns(first);
  document.documentElement.dataset.ready = performance.now().toFixed(0);
}
