/**
 * The planar arm against the wall at the time of the cursor: links, joints, tip, paths, contact force and torques.
 *
 * The drawing stands in the page (`orchestration.paper.page.arm`), in units of 10 mm; this module moves its parts.
 *
 * @typedef {import("../../../report/script/data.js").Run} Run
 * @typedef {{lengths: number[], normal?: number[], offset?: number}} Arm  What `extra.arm` of a run holds: lengths of the
 *   links, m, and of the wall, if there is one, the normal and the distance, m.
 */

import { rowAt, valuesAt } from "../../../report/script/data.js";

const SCALE = 100; // units of the drawing for a metre
const [ARROW, RADIUS, WIDEST] = [45, 15, 2.4]; // units, units, rad: largest force, arcs of torques, largest torque
const [MAGNIFIED, PATH_POINTS] = [24, 600];
const NAMES = ["plant.q", "plant.x", "plant.F_ext", "actuator.tau", "trajectory.x_v", "controller.x_t"];
const columnsOf = (/** @type {string} */ name) => [`${name}[1]`, `${name}[2]`];

/** @param {import("../../../report/script/page.js").Context} context */
export function start({ cursor }) {
  /** @type {(() => void)[]} */
  let frames = [];
  /** @type {Run[]} */
  let wanted = [];
  document.addEventListener("runs", async (event) => {
    const runs = /** @type {CustomEvent<Run[]>} */ (event).detail.filter(({ extra }) => extra?.arm);
    wanted = runs;
    await Promise.all(runs.map((run) => run.load?.(NAMES.flatMap(columnsOf))));
    if (wanted !== runs) return; // others were shown meanwhile
    frames = [...document.querySelectorAll("#arm .run")].flatMap((group, place) => {
      group.toggleAttribute("hidden", !runs[place]);
      return runs[place] ? [mover(/** @type {Element} */ (group), runs[place], cursor)] : [];
    });
    frames.forEach((frame) => frame());
  });
  cursor.addEventListener("cursor", () => frames.forEach((frame) => frame()));
}

/** Draws the paths of a run, and returns what moves its arm. */
/** @param {Element} group @param {Run} run @param {import("../../../report/script/page.js").Context["cursor"]} cursor */
function mover(group, run, cursor) {
  const { lengths, normal: [a, b] = [NaN, NaN], offset = NaN } = /** @type {Arm} */ (run.extra?.arm);
  const vector = (/** @type {string} */ name, /** @type {number} */ row) =>
    columnsOf(name).map((column) => valuesAt(run, column, row)[0] ?? NaN);
  const larger = (/** @type {number} */ most, /** @type {number} */ value) => Math.max(most, Math.abs(value) || 0);
  const largest = (/** @type {string} */ name) =>
    columnsOf(name).reduce((most, column) => run.columns[column]?.reduce(larger, most) ?? most, 0) || 1;
  const set = (/** @type {string} */ part, /** @type {string} */ attribute, /** @type {string} */ value) => {
    const element = group.querySelector(`[data-part=${part}]`);
    element?.toggleAttribute("hidden", value.includes("NaN"));
    if (!value.includes("NaN")) element?.setAttribute(attribute, value);
  };
  const wallAt = (/** @type {number} */ distance) =>
    `rotate(${(Math.atan2(b, a) * 180) / Math.PI}) translate(${SCALE * distance} 0)`;
  for (const [part, name] of [["path", "plant.x"], ["way", "trajectory.x_v"]]) {
    const rows = Array.from({ length: PATH_POINTS }, (_, i) => Math.round((i * (run.time.length - 1)) / (PATH_POINTS - 1)));
    set(part, "points", rows.map((row) => vector(name, row).map((v) => (SCALE * v).toFixed(2)).join()).join(" "));
  }
  set("wall", "transform", wallAt(offset));
  const [mostForce, mostTorque] = [largest("plant.F_ext"), largest("actuator.tau")];
  return () => {
    const [q, x, force, torque, virtual, target] = NAMES.map((name) => vector(name, rowAt(run.time, cursor.time)));
    for (const i of [0, 1]) {
      set(`joint-${i + 1}`, "transform", `rotate(${(q[i] * 180) / Math.PI})`);
      set(`elbow`, "transform", `translate(${SCALE * lengths[0]} 0)`);
      const turn = WIDEST * Math.sign(torque[i]) * Math.sqrt(Math.abs(torque[i]) / mostTorque);
      const end = [RADIUS * Math.cos(turn), RADIUS * Math.sin(turn)].map((v) => v.toFixed(2));
      set(`torque-${i + 1}`, "d", `M ${RADIUS} 0 A ${RADIUS} ${RADIUS} 0 0 ${turn > 0 ? 1 : 0} ${end}`);
      set(`link-${i + 1}`, "x2", String(SCALE * lengths[i]));
    }
    const size = Math.hypot(...force) || 1;
    const [fx, fy] = force.map((part) => ((ARROW * part) / size) * Math.sqrt(size / mostForce));
    set("force", "d", `M ${SCALE * x[0]} ${SCALE * x[1]} l ${fx} ${fy}`);
    for (const [part, place] of Object.entries({ tip: x, virtual, target })) {
      set(part, "transform", `translate(${place.map((v) => SCALE * v)})`);
      set(`near-${part}`, "transform", `translate(${place.map((v, i) => SCALE * MAGNIFIED * (v - x[i]))})`);
    }
    set("near-wall", "transform", wallAt(MAGNIFIED * (offset - a * x[0] - b * x[1])));
  };
}
