/**
 * Panels with curves over time, drawn by Bokeh: one range of time for all, curves that toggle, the values at the cursor.
 *
 * @typedef {import("./data.js").Run} Run
 * @typedef {{column: string, label: string, hidden?: boolean}} Curve
 * @typedef {{title: string, unit: string, factor?: number, curves: Curve[]}} Panel  Factor: of shown to stored values.
 * @typedef {{place: number, run: Run, name: string, levels: import("./pyramid.js").Level[], glyph: any,
 *     value: HTMLElement}} Line  Place: of the run among those that are shown.
 */

import { lateness, rowAt, valuesAt } from "./data.js";
import { level, pyramid } from "./pyramid.js";
import { colour, curveColour } from "./theme.js";

const POINTS = 3000; // of a curve at most: more than the pixels of its panel
const DASHES = ["solid", "dashed", "dotted", "dotdash"];
const [HEIGHT, LEFT, RIGHT] = [210, 66, 12]; // px; room of the scales is the same in all panels, so that times are aligned
const STRIP = 0.035; // of the height of a panel

export class Plots {
  /**
   * @param {HTMLElement} host  Where the panels go.
   * @param {import("./cursor.js").Cursor} cursor  Plots that share it zoom together.
   * @param {Panel[]} panels
   * @param {HTMLElement} [note]  Says whether the curves show every row.
   */
  constructor(host, cursor, panels, note) {
    this.host = host;
    this.cursor = cursor;
    this.panels = panels;
    this.note = note;
    /** @type {Run[]} */
    this.runs = [];
    /** @type {{panel: Panel, figure: any, view: any, bands: any[], lines: Line[], area: HTMLElement}[]} */
    this.drawn = [];
    this.shape = "";
    /** @type {Map<string, boolean>} What the reader switched on or off, by place of the run and column. */
    this.switched = new Map();
    cursor.addEventListener("interval", () => this.refresh());
    cursor.addEventListener("cursor", () => this.showCursor());
    document.addEventListener("theme", () => this.showRuns(this.runs));
    new ResizeObserver(() => requestAnimationFrame(() => this.showCursor())).observe(host); // when Bokeh has the new size
  }

  /** Draw runs in the place of those before; curves that were switched off stay so. @param {Run[]} runs */
  async showRuns(runs) {
    const names = this.panels.flatMap(({ curves }) => curves.map(({ column }) => column));
    this.runs = runs;
    await Promise.all(runs.map((run) => run.load?.(names)));
    if (this.runs !== runs) return; // others were asked for meanwhile
    const kinds = runs.map((run) => names.map((name) => run.columns[name] && lateness(run, name)));
    const looks = runs.map(({ label, phases }) => [runs.length > 1 && label, Object.keys(phases ?? {})]);
    const shape = JSON.stringify([this.panels, kinds, looks, document.documentElement.dataset.theme]);
    if (shape !== this.shape) {
      const { documents } = /** @type {any} */ (window).Bokeh;
      for (const { figure, view } of this.drawn) {
        view.remove();
        documents.splice(documents.indexOf(figure.document), 1); // or Bokeh keeps what was drawn
      }
      [this.shape, this.drawn, this.host.textContent] = [shape, [], ""];
      await Promise.all(this.panels.map((panel) => this.draw(panel, this.drawn)));
    }
    for (const { bands, lines } of this.drawn) {
      for (const { phase, place, quad } of bands) quad.data_source.data = edges(this.runs[place].phases?.[phase] ?? []);
      for (const line of lines) {
        line.run = this.runs[line.place];
        line.levels = pyramid(line.run.columns[line.name], line.run.bins?.[line.name]);
      }
    }
    this.refresh();
  }

  /** Draw a panel in the colours of the theme; its bands and curves get their data later. */
  /** @param {Panel} panel @param {any[]} drawn  Gets the panel when it is drawn. */
  async draw(panel, drawn) {
    const { Plotting, Range1d } = /** @type {any} */ (window).Bokeh;
    const element = this.host.appendChild(copyOf("panel"));
    const [title, legend, area] = /** @type {HTMLElement[]} */ ([...element.children]);
    title.textContent = panel.unit ? `${panel.title} (${panel.unit})` : panel.title;
    area.setAttribute("aria-label", `${title.textContent} over time`);
    const [x_range, y_range] = [new Range1d({ start: this.cursor.from, end: this.cursor.to }), new Range1d()];
    const figure = Plotting.figure({
      ...{ height: HEIGHT, sizing_mode: "stretch_width", min_border_left: LEFT, min_border_right: RIGHT },
      ...{ x_range, y_range, extra_y_ranges: { share: new Range1d({ start: 0, end: 1 }) } },
      ...{ background_fill_color: null, border_fill_color: null, outline_line_color: null },
      ...{ tools: matchMedia("(pointer: coarse)").matches ? "" : "xbox_zoom", toolbar_location: null }, // a finger scrolls
    });
    const ink = colour("ink");
    const axes = { axis_line_color: ink, major_tick_line_color: ink, minor_tick_line_color: null, major_label_text_color: ink };
    for (const axis of [...figure.below, ...figure.left]) axis.setv(axes);
    for (const grid of figure.center) grid.setv({ grid_line_color: colour("faint") });
    x_range.change.connect(() => this.cursor.zoom(x_range.start, x_range.end));
    for (const kind of ["mousemove", "tap"]) figure.on_event(kind, (/** @type {any} */ event) => this.point(event));
    const bands = this.runs.flatMap((_, place) => this.bands(figure, place));
    const lines = this.runs.flatMap(({ columns }, place) =>
      panel.curves.flatMap((curve, order) => (columns[curve.column] ? [this.line(figure, legend, curve, place, order)] : [])),
    );
    drawn.push({ panel, figure, view: await Plotting.show(figure, area), bands, lines, area });
  }

  /** Bands of the phases of a run. Of several runs each has a strip of its own. @param {any} figure @param {number} place */
  bands(figure, place) {
    const alone = this.runs.length === 1;
    const top = alone ? 1 : 1 - 1.3 * STRIP * place;
    return Object.keys(this.runs[place].phases ?? {}).map((phase) => {
      const bottom = alone && phase !== "saturated" ? 0 : top - STRIP;
      const fill = colour(phase.replace("in ", ""));
      const looks = { fill_color: fill, line_color: fill, line_width: 0.7, level: "underlay", y_range_name: "share" };
      return { phase, place, quad: figure.quad([], [], bottom, top, looks) };
    });
  }

  /** A curve, and its button in the legend. */
  /** @param {any} figure @param {HTMLElement} legend @param {Curve} curve @param {number} place @param {number} order */
  line(figure, legend, { column: name, label, hidden = false }, place, order) {
    const [run, alone] = [this.runs[place], this.runs.length === 1];
    const [line_color, line_dash] = alone ? [curveColour(order), "solid"] : [curveColour(place), DASHES[order % DASHES.length]];
    const looks = { line_width: 1.5, line_color, line_dash };
    const glyph = lateness(run, name) ? figure.step([], [], "after", looks) : figure.line([], [], looks);
    const [button, value] = /** @type {HTMLElement[]} */ ([...legend.appendChild(copyOf("curve")).children]);
    button.lastElementChild?.append(alone ? label : `${run.label}: ${label}`);
    const { style } = /** @type {HTMLElement} */ (button.firstElementChild);
    [style.borderTopColor, style.borderTopStyle] = [line_color, line_dash];
    const show = (/** @type {boolean} */ visible) => (button.ariaPressed = String((glyph.visible = visible)));
    show(this.switched.get(`${place} ${name}`) ?? this.switched.get(`0 ${name}`) ?? !hidden);
    button.addEventListener("click", () => {
      this.switched.set(`${place} ${name}`, !glyph.visible);
      show(!glyph.visible);
      this.refresh();
    });
    return { place, run, name, levels: [], glyph, value };
  }

  /** Set the cursor to the time at a pointer; while it plays, only a click does. @param {any} event  Of Bokeh. */
  point({ event_name, x }) {
    if (x < this.cursor.from || x > this.cursor.to || (event_name === "mousemove" && this.cursor.playing)) return;
    this.cursor.set(x);
  }

  /** Show the time of the cursor in all panels, and the values of the rows that hold there. */
  showCursor() {
    for (const { panel, lines, view, area } of this.drawn) {
      const { left, width } = view.frame.bbox;
      const share = (this.cursor.time - this.cursor.from) / (this.cursor.to - this.cursor.from);
      const mark = /** @type {HTMLElement} */ (area.firstElementChild);
      mark.hidden = share < 0 || share > 1;
      mark.style.transform = `translateX(${left + share * width}px)`;
      for (const { run, name, value } of lines) {
        const found = valuesAt(run, name, rowAt(run.time, this.cursor.time)).map((v) => v * (panel.factor ?? 1));
        value.textContent = `${found.map((v) => Number(v.toPrecision(6))).join(" to ")} ${panel.unit}`;
      }
    }
  }

  /** Give each curve the points that the range of time needs, and fit the scales of values. */
  refresh() {
    let rows = 1;
    for (const { panel, figure, lines } of this.drawn) {
      let [least, most] = [Infinity, -Infinity];
      for (const line of lines.filter(({ glyph }) => glyph.visible)) {
        const { bin, ...points } = this.points(line, panel.factor ?? 1);
        line.glyph.data_source.data = points;
        rows = Math.max(rows, bin);
        const finite = points.y.filter(Number.isFinite);
        [least, most] = [Math.min(least, ...finite), Math.max(most, ...finite)];
      }
      const room = most > least ? 0.06 * (most - least) : Math.abs(most) < Infinity ? Math.abs(most) || 1 : 1;
      figure.y_range.setv(least <= most ? { start: least - room, end: most + room } : { start: 0, end: 1 });
      figure.x_range.setv({ start: this.cursor.from, end: this.cursor.to });
    }
    const shown = rows > 1 ? `the least and the largest value of every ${rows} rows; zoom in for more.` : "every row.";
    if (this.note) this.note.textContent = `The curves show ${shown}`;
    this.showCursor();
  }

  /** Points of a curve within the range of time, and one beyond each end. @param {Line} line @param {number} factor */
  points({ run, name, levels }, factor) {
    const { time } = run;
    const [first, last] = [rowAt(time, this.cursor.from), Math.min(rowAt(time, this.cursor.to) + 1, time.length - 1)];
    const { bin, values } = level(levels, last - first, POINTS);
    const late = lateness(run, name); // a held value is drawn from the instant at which it came about
    const [begin, end] = [Math.floor(first / bin), Math.floor((last + late) / bin) + 1].map((k) => (bin === 1 ? k : 2 * k));
    const y = values.slice(begin, end).map((value) => factor * value);
    const rowOf = (/** @type {number} */ i) => (bin === 1 ? i : (i >> 1) * bin + (i % 2) * (bin >> 1)) - late;
    return { bin, x: y.map((_, i) => time[Math.min(Math.max(rowOf(begin + i), 0), time.length - 1)]), y };
  }
}

/** Left and right edges of bands. @param {number[][]} spans */
const edges = (spans) => ({ left: spans.map(([begin]) => begin), right: spans.map(([, end]) => end) });

/** The content of a template of the page. @param {string} id */
const copyOf = (id) => {
  const { content } = /** @type {HTMLTemplateElement} */ (document.getElementById(id));
  return /** @type {HTMLElement} */ (content.firstElementChild?.cloneNode(true));
};
