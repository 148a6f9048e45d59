/** The one time of the page, which arm and plots show, the interval that plots show, and the player. */

/** Each change is told by an event ``cursor``. */
export class Cursor extends EventTarget {
  begin = 0; // s, as the two below
  end = 1;
  time = 0;
  speed = 0.25; // simulated seconds per second
  playing = false;

  /** Show a time, s, and stop playing. @param {number} time @param {boolean} [playing] */
  set(time, playing = false) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.playing = playing && this.time < this.end;
    this.dispatchEvent(new Event("cursor"));
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

/** The interval of time that all plots show, s; each change is told by an event ``interval``. */
export class Interval extends EventTarget {
  start = 0;
  end = 1;

  /** @param {number} start @param {number} end  s */
  set(start, end) {
    if ((start === this.start && end === this.end) || !(start < end)) return;
    Object.assign(this, { start, end }).dispatchEvent(new Event("interval"));
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
