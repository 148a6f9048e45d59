/**
 * Judges the claims C1 to C10 for the numbers of the form, with one seed of the noise.
 *
 * @typedef {import("./state.js").Data} Data
 * @typedef {import("./state.js").State} State
 * @typedef {import("./state.js").Run} Run
 * @typedef {import("./measures.js").Rows} Rows
 * @typedef {ReturnType<typeof summary>} Summary
 * @typedef {{id: string, holds: boolean|null, values: Record<string, number[]>, why: string}} Answer
 *   `holds` is null if the claim cannot be judged, and `why` says why
 */
import { MEASURED, REFERENCE, contact, distance, endDistance, freeError, largest } from "./measures.js";
import { norms, referenceDistance, steadyForce, summary } from "./measures.js";
import { preset, runOf } from "./state.js";

const FIXED_MASS = "without adaptation";
const ADAPTIVE = ["fig5", "fig6", "fig7"];

/** The runs that claims need, each made when it is first asked for; a failure is kept as well. */
export class Evidence {
  /** @param {Data} data @param {State} state @param {(run: Run, columns: string[]) => Rows} make */
  constructor(data, state, make) {
    this.data = data;
    this.state = state;
    this.make = make;
    this.start = data.numbers.start;
    /** @type {Map<string, Rows|Error>} */
    this.found = new Map();
    /** @type {Map<string, Summary>} */
    this.summaries = new Map();
  }

  /** @param {string} name @returns {Run} a run of a figure, with its own controller and the changes of the form */
  run(name) {
    const { figure, values } = this.data.fixedMass;
    const run = runOf(this.data, { ...preset(this.data, name === FIXED_MASS ? figure : name), changes: this.state.changes });
    return name === FIXED_MASS ? { ...run, values: { ...run.values, ...values } } : run;
  }

  /** @param {string} name @returns {Rows} */
  rows(name) {
    if (!this.found.has(name)) this.found.set(name, this.#made(name));
    const rows = /** @type {Rows|Error} */ (this.found.get(name));
    if (rows instanceof Error) throw rows;
    return rows;
  }

  /** @param {string} name @returns {Rows|Error} */
  #made(name) {
    try {
      return this.make(this.run(name), name === "fig2" ? [...MEASURED, ...REFERENCE] : MEASURED);
    } catch (error) {
      return new Error(`the run ${name} fails: ${error instanceof Error ? error.message : error}`);
    }
  }

  /** @param {string} name @returns {Summary} */
  summary(name) {
    const found = this.summaries.get(name) ?? summary(this.rows(name), this.m2, this.rows("ideal"), this.data.numbers);
    this.summaries.set(name, found);
    return found;
  }

  /** @param {(of: Summary) => number} value @returns {number[]} of Figs. 5 to 7 */
  each(value) {
    return ADAPTIVE.map((name) => value(this.summary(name)));
  }

  /** @returns {number} mass of the arm, kg */
  get m2() {
    return this.run("fig5").values["plant.m[2]"];
  }
}

/** @type {Record<string, (from: Evidence) => Record<string, number|number[]>>} */
const QUESTIONS = {
  C1: (from) => {
    const rows = from.rows("fig2"); // Figs. 2 and 3 show one run
    const apart = referenceDistance(rows);
    const { first } = contact(rows);
    const before = largest(apart, (k) => rows.time[k] < first);
    const later = largest(apart, (k) => rows.time[k] >= first);
    return { TIRT_BEFORE_CONTACT: before, TIRT_GROWTH: later / before };
  },
  C2: (from) => {
    const rows = from.rows("fig2");
    const touch = contact(rows);
    const wall = from.run("fig2").values["plant.wall_offset"];
    const [a, b] = from.data.numbers.semiAxis;
    const height = b * Math.sqrt(1 - (wall / a) ** 2);
    const ends = [distance(touch.enter, [-wall, height]), distance(touch.leave, [-wall, -height])];
    const [e, end] = [largest(norms(rows, "controller.e", 1)), endDistance(rows, from.start)];
    return { TRUE_MASS_ERROR: e, SLIDE_ENDS: ends, BOUNCES: touch.phases - 1, SLIDE_SHARE: touch.share, END: end };
  },
  C3a: (from) => {
    const [right, wrong] = ["fig2", "fig4"].map((name) => largest(norms(from.rows(name), "controller.e", 1)));
    return { WRONG_MASS_ERROR: wrong, WRONG_MASS_GROWTH: wrong / right };
  },
  C3b: (from) => {
    const [right, wrong] = [from.rows("fig2"), from.rows("fig4")];
    const ratios = [contact(wrong).peak / contact(right).peak, steadyForce(wrong) / steadyForce(right)];
    return { WRONG_MASS_FORCE: largest(ratios) };
  },
  C4: (from) => ({ M2_SETTLED: from.each((s) => s.m2Settled), M2_AT_CONTACT: from.each((s) => s.m2AtContact) }),
  C5: (from) => ({
    M2_IN_CONTACT: from.each((s) => s.m2InContact),
    M2_FLUCTUATION: from.each((s) => s.m2Fluctuation),
  }),
  C6: (from) => ({ M2_RECOVERY: from.each((s) => s.m2Recovery) }),
  C7: (from) => {
    const [free, limited] = [from.summary("fig5"), from.summary("fig6")];
    return {
      SATURATED_ERROR: limited.eContact / free.eContact,
      SATURATED_FORCE: limited.forceError / free.forceError,
      BOUNDED_ERROR: limited.eMax,
      END: limited.end,
    };
  },
  C8: (from) => {
    const [one, two] = [from.summary("fig5").torque, from.summary("fig7").torque];
    const allowed = [1, 2].map((joint) => from.run("fig6").values[`actuator.tau_max[${joint}]`]);
    return { TORQUE_RATIO: two.map((t, i) => t / one[i]), TORQUE_WITHIN: two.map((t, i) => t - allowed[i]) };
  },
  C9: (from) => {
    const { eStart, eFree } = from.summary("fig7");
    return { START_ERROR: eStart, FREE_ERROR: eFree, FIXED_MASS_RATIO: eStart / freeError(from.rows(FIXED_MASS)) };
  },
  C10: (from) => {
    const [one, two] = [from.summary("fig5"), from.summary("fig7")];
    return {
      LARGER_ERROR: two.eContact / one.eContact,
      SLIGHTLY_LARGER_ERROR: two.eContact - one.eContact,
      LARGER_FORCE: two.forceError / one.forceError,
      SLIGHTLY_LARGER_FORCE: two.forceError - one.forceError,
    };
  },
};

/** @type {Record<string, (value: number, limit: number) => boolean>} */
const COMPARE = { "<": (v, l) => v < l, "<=": (v, l) => v <= l, ">": (v, l) => v > l, ">=": (v, l) => v >= l };

/** @param {Evidence} from @param {string} id of a claim @returns {Answer} */
export function answer(from, id) {
  try {
    const measured = Object.entries(QUESTIONS[id](from)).map(([name, value]) => [name, [value].flat()]);
    const values = /** @type {Record<string, number[]>} */ (Object.fromEntries(measured));
    const met = Object.entries(values).map(([name, found]) => {
      const { comparison, limit } = from.data.criteria[name];
      return found.length > 0 && found.every((value) => COMPARE[comparison](value, limit));
    });
    return { id, holds: met.every(Boolean), values, why: "" };
  } catch (error) {
    return { id, holds: null, values: {}, why: error instanceof Error ? error.message : String(error) };
  }
}
