/** What the reader chooses: runs, columns to draw besides the panels, and the interval of time. */

const MOST = 7; // columns that colours can tell apart
/** @typedef {import("./plots.js").Plots} Plots  @typedef {import("./plots.js").Panel} Panel */

/** Tell what is checked in a list of check boxes, at most so many. */
/** @param {HTMLElement | null} list @param {number} most @param {(chosen: string[]) => void} tell */
export function connectBoxes(list, most, tell) {
  list?.addEventListener("change", () => {
    const boxes = /** @type {HTMLInputElement[]} */ ([...list.querySelectorAll("input")]);
    const chosen = boxes.flatMap(({ checked, value }) => (checked ? [value] : []));
    for (const each of boxes) each.disabled = chosen.length >= most && !each.checked;
    tell(chosen);
  });
}

/** Let a list of check boxes choose columns, each unit in a panel. */
/** @param {HTMLElement | null} list @param {Plots} plots @param {Panel[]} panels  Panels that stay. */
export function connectChoice(list, plots, panels) {
  connectBoxes(list, MOST, (chosen) => {
    const unit = (/** @type {string} */ name) => plots.runs.map(({ units }) => units[name]).find(Boolean) ?? "";
    const added = [...new Set(chosen.map(unit))].map((each) => ({
      title: "Chosen columns",
      unit: each,
      curves: chosen.filter((name) => unit(name) === each).map((name) => ({ column: name, label: name })),
    }));
    plots.panels = [...panels, ...added];
    plots.showRuns(plots.runs);
  });
}

/** Let buttons zoom and move the interval of time, by their factor and share of it. */
/** @param {HTMLElement} bar @param {import("./cursor.js").Cursor} cursor */
export function connectZoom(bar, cursor) {
  bar.addEventListener("click", (event) => {
    const { zoom, move } = /** @type {HTMLElement} */ (event.target).dataset;
    const { time, from, to } = cursor;
    const middle = time > from && time < to ? time : (from + to) / 2;
    const ends = [from, to].map((t) => middle + (to - from) * Number(move) + (t - middle) * Number(zoom));
    const [start, end] = zoom ? ends : [cursor.begin, cursor.end];
    cursor.zoom(start, end);
  });
}
