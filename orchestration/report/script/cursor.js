/** The one time of the page, which arm and plots show, the interval that plots show, and the player. */

/** A change of the time is told by an event ``cursor``, one of the interval by an event ``interval``. */
export class Cursor extends EventTarget {
  begin = 0; // of the runs, s, as all times
  end = 1;
  from = 0; // of the interval
  to = 1;
  time = 0;
  speed = 0.25; // simulated seconds per second
  playing = false;

  /** Show a time, s, and stop playing. @param {number} time @param {boolean} [playing] */
  set(time, playing = false) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.playing = playing && this.time < this.end;
    this.dispatchEvent(new Event("cursor"));
  }

  /** Let all plots show an interval, s. @param {number} from @param {number} to */
  zoom(from, to) {
    if ((from === this.from && to === this.to) || !(from < to)) return;
    Object.assign(this, { from, to }).dispatchEvent(new Event("interval"));
  }

  play() {
    let before = performance.now();
    const frame = (/** @type {number} */ now) => {
      if (!this.playing) return;
      this.set(this.time + (Math.max(0, now - before) / 1000) * this.speed, true);
      before = now;
      requestAnimationFrame(frame);
    };
    this.set(this.time < this.end ? this.time : this.begin, true);
    requestAnimationFrame(frame);
  }
}

/** Connect button, slider and speed of a player with a cursor. @param {HTMLElement} player @param {Cursor} cursor */
export function connectPlayer(player, cursor) {
  /** @type {any[]} */
  const [button, slider, shown, speed] = [...player.querySelectorAll("[data-part]")];
  button.addEventListener("click", () => (cursor.playing ? cursor.set(cursor.time) : cursor.play()));
  slider.addEventListener("input", () => cursor.set(cursor.begin + slider.valueAsNumber * (cursor.end - cursor.begin)));
  speed.addEventListener("change", () => (cursor.speed = Number(speed.value)));
  cursor.addEventListener("cursor", () => {
    slider.value = (cursor.time - cursor.begin) / (cursor.end - cursor.begin || 1);
    shown.textContent = `t = ${cursor.time.toFixed(4)} s`;
    slider.setAttribute("aria-valuetext", shown.textContent);
    button.textContent = cursor.playing ? "Pause" : "Play";
  });
}
