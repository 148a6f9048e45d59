/**
 * Panels with curves over time, drawn by Bokeh: one range of time for all, curves that toggle, the values at the cursor.
 *
 * @typedef {import("./data.js").Run} Run
 * @typedef {{column: string, label: string, hidden?: boolean}} Curve
 * @typedef {{title: string, unit: string, factor?: number, curves: Curve[]}} Panel  Factor: of shown to stored values.
 * @typedef {{run: Run, name: string, levels: import("./pyramid.js").Level[], source: any, glyph: any,
 *     place: number, number: number, item: HTMLElement, value: HTMLElement, visible: boolean}} Line
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
   * @param {import("./cursor.js").Cursor} cursor
   * @param {import("./cursor.js").Interval} range  Plots that share it zoom together.
   * @param {Panel[]} panels
   */
  constructor(host, cursor, range, panels) {
    this.host = host;
    this.cursor = cursor;
    this.range = range;
    this.panels = panels;
    /** @type {Run[]} */
    this.runs = [];
    /** @type {{panel: Panel, figure: any, view: any, bands: any[], lines: Line[], area: HTMLElement}[]} */
    this.drawn = [];
    this.shape = "";
    this.waiting = false;
    range.addEventListener("interval", () => this.refreshSoon());
    cursor.addEventListener("cursor", () => this.showCursor());
    document.addEventListener("theme", () => this.restyle());
    new ResizeObserver(() => this.refreshSoon()).observe(host);
  }

  /** Draw runs in the place of those before; curves that were switched off stay so. @param {Run[]} runs */
  async showRuns(runs) {
    const off = new Set(this.drawn.flatMap(({ lines }) => lines.filter(({ visible }) => !visible).map(({ name }) => name)));
    const names = this.panels.flatMap(({ curves }) => curves.map(({ column }) => column));
    await Promise.all(runs.map((run) => run.load?.(names)));
    this.runs = runs;
    const kinds = runs.map((run) => names.map((name) => run.columns[name] && lateness(run, name)));
    const looks = runs.map(({ label, phases }) => [runs.length > 1 && label, Object.keys(phases ?? {})]);
    const shape = JSON.stringify([this.panels, kinds, looks]);
    if (shape !== this.shape) {
      this.drawn.forEach(({ view }) => view.remove());
      [this.shape, this.drawn, this.host.textContent] = [shape, [], ""];
      await Promise.all(this.panels.map((panel) => this.draw(panel, off, this.drawn)));
    }
    for (const { bands, lines } of this.drawn) {
      for (const { phase, place, quad } of bands) quad.data_source.data = edges(runs[place].phases?.[phase] ?? []);
      for (const line of lines) {
        line.run = runs[line.place];
        line.levels = pyramid(line.run.columns[line.name], line.run.bins?.[line.name]);
      }
    }
    this.restyle();
    this.showCursor();
  }

  /** @param {Panel} panel @param {Set<string>} off  Columns whose curves are not shown. @param {any[]} drawn */
  async draw(panel, off, drawn) {
    const { Plotting, Range1d, ColumnDataSource } = /** @type {any} */ (window).Bokeh;
    const element = this.host.appendChild(copyOf("panel"));
    const [title, legend, area] = /** @type {HTMLElement[]} */ ([...element.children]);
    title.textContent = panel.unit ? `${panel.title} (${panel.unit})` : panel.title;
    area.setAttribute("aria-label", `${title.textContent} over time`);
    const figure = Plotting.figure({
      ...{ height: HEIGHT, sizing_mode: "stretch_width", min_border_left: LEFT, min_border_right: RIGHT },
      ...{ x_range: new Range1d(), y_range: new Range1d(), extra_y_ranges: { share: new Range1d({ start: 0, end: 1 }) } },
      ...{ background_fill_color: null, border_fill_color: null, outline_line_color: null },
      ...{ tools: "xbox_zoom,reset", toolbar_location: null },
    });
    if (matchMedia("(pointer: coarse)").matches) figure.toolbar.active_drag = null; // a finger scrolls the page
    figure.x_range.setv({ start: this.range.start, end: this.range.end });
    figure.x_range.change.connect(() => this.range.set(figure.x_range.start, figure.x_range.end));
    const alone = this.runs.length === 1;
    const bands = this.runs.flatMap(({ phases }, place) =>
      Object.keys(phases ?? {}).map((phase) => {
        const looks = { source: new ColumnDataSource({ data: edges([]) }), line_width: 0.7, level: "underlay" };
        const top = 1 - (alone ? 0 : 1.3 * STRIP * place);
        const bottom = alone && phase !== "saturated" ? 0 : top - STRIP;
        const [left, right] = [{ field: "left" }, { field: "right" }];
        return { phase, place, quad: figure.quad(left, right, bottom, top, { ...looks, y_range_name: "share" }) };
      }),
    );
    /** @type {Line[]} */
    const lines = [];
    for (const [place, run] of this.runs.entries()) {
      for (const [order, { column: name, label, hidden }] of panel.curves.entries()) {
        if (!run.columns[name]) continue;
        const source = new ColumnDataSource({ data: { x: [], y: [] } });
        const looks = { source, line_width: 1.5, line_dash: alone ? "solid" : DASHES[order % DASHES.length] };
        const [x, y] = [{ field: "x" }, { field: "y" }];
        const glyph = lateness(run, name) ? figure.step(x, y, "after", looks) : figure.line(x, y, looks);
        const item = legend.appendChild(copyOf("curve"));
        const [button, value] = /** @type {HTMLElement[]} */ ([...item.children]);
        button.lastElementChild?.append(alone ? label : `${run.label}: ${label}`);
        /** @type {HTMLElement} */ (button.firstElementChild).style.borderTopStyle = looks.line_dash;
        const number = alone ? order : place;
        const line = { run, name, levels: [], source, glyph, place, number, item, value, visible: true };
        const toggle = () => button.setAttribute("aria-pressed", String((line.visible = !line.visible)));
        if (off.has(name) || hidden) toggle();
        button.addEventListener("click", () => (toggle(), this.refresh()));
        lines.push(line);
      }
    }
    for (const kind of ["pointermove", "click"]) area.addEventListener(kind, (event) => this.point(view, area, event));
    const view = await Plotting.show(figure, area);
    drawn.push({ panel, figure, view, bands, lines, area });
  }

  /** Set the cursor to where a pointer is; while it plays, only a click does. */
  /** @param {any} view @param {HTMLElement} area @param {any} event */
  point(view, area, event) {
    const { left, width } = view.frame.bbox;
    const share = (event.clientX - area.getBoundingClientRect().left - left) / width;
    if (share < 0 || share > 1 || (event.type === "pointermove" && (this.cursor.playing || event.buttons))) return;
    this.cursor.set(this.range.start + share * (this.range.end - this.range.start));
  }

  /** Show the time of the cursor in all panels, and the values of the rows that hold there. */
  showCursor() {
    for (const { panel, lines, view, area } of this.drawn) {
      const { left, width } = view.frame.bbox;
      const share = (this.cursor.time - this.range.start) / (this.range.end - this.range.start);
      const mark = /** @type {HTMLElement} */ (area.firstElementChild);
      mark.hidden = share < 0 || share > 1;
      mark.style.transform = `translateX(${left + share * width}px)`;
      for (const { run, name, value } of lines) {
        const found = valuesAt(run, name, rowAt(run.time, this.cursor.time)).map((v) => v * (panel.factor ?? 1));
        value.textContent = `${found.map((v) => Number(v.toPrecision(6))).join(" to ")} ${panel.unit}`;
      }
    }
  }

  refreshSoon() {
    if (!this.waiting) requestAnimationFrame(() => ((this.waiting = false), this.refresh(), this.showCursor()));
    this.waiting = true;
  }

  /** Give each curve the points that the range of time needs, and fit the scales of values. */
  refresh() {
    let rows = 1;
    for (const { panel, figure, lines } of this.drawn) {
      let [least, most] = [Infinity, -Infinity];
      for (const line of lines) {
        line.glyph.visible = line.visible;
        if (!line.visible) continue;
        const { bin, ...points } = this.points(line, panel.factor ?? 1);
        line.source.data = points;
        rows = Math.max(rows, bin);
        const finite = points.y.filter(Number.isFinite);
        [least, most] = [Math.min(least, ...finite), Math.max(most, ...finite)];
      }
      const room = most > least ? 0.06 * (most - least) : Math.abs(most) < Infinity ? Math.abs(most) || 1 : 1;
      const [start, end] = least <= most ? [least - room, most + room] : [0, 1];
      figure.y_range.setv({ start, end });
      figure.x_range.setv({ start: this.range.start, end: this.range.end });
    }
    this.host.dispatchEvent(new CustomEvent("thinned", { detail: rows }));
  }

  /** Points of a curve within the range of time, and one beyond each end. @param {Line} line @param {number} factor */
  points({ run, name, levels }, factor) {
    const { time } = run;
    const [first, last] = [rowAt(time, this.range.start), Math.min(rowAt(time, this.range.end) + 1, time.length - 1)];
    const { bin, values } = level(levels, last - first, POINTS);
    const late = lateness(run, name); // a held value is drawn from the instant at which it came about
    const [begin, end] = [Math.floor(first / bin), Math.floor((last + late) / bin) + 1].map((k) => (bin === 1 ? k : 2 * k));
    const y = values.slice(begin, end).map((value) => factor * value);
    const rowOf = (/** @type {number} */ i) => (bin === 1 ? i : (i >> 1) * bin + (i % 2) * (bin >> 1)) - late;
    return { bin, x: y.map((_, i) => time[Math.min(Math.max(rowOf(begin + i), 0), time.length - 1)]), y };
  }

  /** Take the colours of the theme in force. */
  restyle() {
    const [ink, faint] = [colour("ink"), colour("faint")];
    const axes = { axis_line_color: ink, major_tick_line_color: ink, minor_tick_line_color: null, major_label_text_color: ink };
    for (const { figure, lines, bands } of this.drawn) {
      for (const axis of [...figure.below, ...figure.left]) axis.setv(axes);
      for (const grid of figure.center) grid.setv({ grid_line_color: faint });
      for (const { phase, quad } of bands) {
        const fill = colour(phase.replace("in ", ""));
        quad.glyph.setv({ fill_color: { value: fill }, line_color: { value: fill } });
      }
      for (const { number, glyph, item } of lines) {
        glyph.glyph.line_color = curveColour(number);
        item.style.setProperty("--curve", curveColour(number));
      }
    }
    this.refresh();
  }
}

/** Left and right edges of bands. @param {number[][]} spans */
const edges = (spans) => ({ left: spans.map(([begin]) => begin), right: spans.map(([, end]) => end) });

/** The content of a template of the page. @param {string} id */
const copyOf = (id) => {
  const { content } = /** @type {HTMLTemplateElement} */ (document.getElementById(id));
  return /** @type {HTMLElement} */ (content.firstElementChild?.cloneNode(true));
};
