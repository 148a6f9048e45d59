/**
 * Runs a system of FMUs that was exported as WebAssembly, in node 18 and later and in browsers:
 *
 *     const system = await load(bytes, description); // the content of NAME.wasm, and the object in NAME.json
 *     const run = system.create();
 *     run.set({ "controller.K[1]": 4000 });
 *     run.initialize();
 *     const rows = run.run(1000, { columns: ["plant.x[1]"], every: 10 }); // rows.time, rows["plant.x[1]"]
 *
 * @typedef {Object<string, Float64Array>} Rows columns by name; `time`, s, is always one of them
 */
const ABI = 1;
const MOST_BYTES = 0x7fff0000;

/** Says what was refused or has failed; `rows` has the complete rows of a recording until then. */
export class SystemError extends Error {
  name = "SystemError";
  /** @type {Rows|undefined} */ rows;
}

/**
 * @param {BufferSource|WebAssembly.Module} module
 * @param {Object} description
 * @returns {Promise<{description: Object, create: function(): Run}>}
 */
export async function load(module, description) {
  const compiled = module instanceof WebAssembly.Module ? module : await WebAssembly.compile(module);
  const { exports } = await WebAssembly.instantiate(compiled);
  exports._initialize?.(); // of modules with a C library
  const { name, abi } = description;
  must(abi === ABI, `${name}: the description has version ${abi} of the interface, the host version ${ABI}.`);
  const identity = textAt(exports.memory, exports.identity());
  must(identity === description.identity, `${name}: the description belongs to another module than ${identity}.`);
  const variables = new Map(description.variables.map((variable) => [variable.name, variable.index]));
  return { description, create: () => new Run(exports, description, variables) };
}

/** One run of a system, with values and time of its own; there may be any number of runs side by side. */
class Run {
  constructor(wasm, description, variables) {
    Object.assign(this, { wasm, description, variables, address: wasm.create() >>> 0 });
    must(this.address, `${description.name}: there is no memory for another run.`);
  }

  /** Frees the memory of this run, which cannot be used afterwards. */
  free() {
    this.wasm.destroy(this.#live());
    this.address = 0;
  }

  /** Puts all values back to their starts. */
  reset() {
    this.wasm.reset(this.#live());
  }

  /** @param {Object<string, number|boolean>} values by name */
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      const index = this.#index(name);
      const fits = typeof value === "number" || typeof value === "boolean";
      must(fits, `${name}: ${JSON.stringify(value)} is not a number or a Boolean.`);
      this.#check(this.wasm.set(this.#live(), index, Number(value)), name);
    }
  }

  /** @param {number} step of a module whose runs may have other steps than the system, s */
  setStep(step) {
    must(this.wasm.set_step, `${this.description.name} has a fixed step of ${this.description.step} s.`);
    const taken = this.wasm.set_step(this.#live(), step);
    must(taken, `step = ${step} s: a step is positive, and is set before the initialization.`);
  }

  /** @param {string} name @returns {number} value of a variable; Booleans are 0 and 1 */
  get(name) {
    return this.wasm.get(this.#live(), this.#index(name));
  }

  /** @returns {number} s */
  get time() {
    return this.wasm.time(this.#live());
  }

  /** Ends the setting of start values. @param {number} time start time, s */
  initialize(time = this.description.startTime) {
    this.#check(this.wasm.initialize(this.#live(), time));
  }

  /**
   * Makes n steps. Row 0 shows the present state; a row follows after each `every` steps.
   * @param {number} n
   * @param {{columns?: string[], every?: number}} recorded nothing is recorded without columns
   * @returns {Rows} arrays of their own, which stay as they are
   */
  run(n, { columns, every = 1 } = {}) {
    const run = this.#live();
    must(isCount(n), `n = ${n} is not a whole number of 0 to 2^32 - 1.`);
    must(isCount(every) && every, `every = ${every} is not a whole number of 1 to 2^32 - 1.`);
    if (!columns) {
      this.#check(this.wasm.step(run, n));
      return {};
    }
    const indices = columns.map((name) => this.#index(name));
    const length = Math.floor(n / every) + 1;
    const bytes = 8 * length * (1 + columns.length);
    const list = this.wasm.allocate(4 * columns.length) >>> 0;
    const place = list && bytes <= MOST_BYTES ? this.wasm.allocate(bytes) >>> 0 : 0;
    try {
      const size = `${length} rows of ${1 + columns.length} columns take ${Math.ceil(bytes / 2 ** 20)} MiB`;
      must(place, `${size}, more than there is; make fewer steps at once, or record fewer of them.`);
      new Uint32Array(this.wasm.memory.buffer, list, indices.length).set(indices);
      const done = this.wasm.record(run, n, every, list, indices.length, place);
      const complete = this.wasm.complete_rows(run);
      const column = (i) => new Float64Array(this.wasm.memory.buffer, place + 8 * i * length, complete).slice();
      const rows = Object.fromEntries(["time", ...columns].map((name, i) => [name, column(i)]));
      this.#check(done, this.description.name, rows);
      return rows;
    } finally {
      this.wasm.release(place);
      this.wasm.release(list);
    }
  }

  #live() {
    must(this.address, `This run of ${this.description.name} was freed.`);
    return this.address;
  }

  #index(name) {
    const known = this.variables.has(name);
    must(known, `${this.description.name} has no variable ${name}; its description lists all names.`);
    return this.variables.get(name);
  }

  #check(done, subject = this.description.name, rows = undefined) {
    if (done) return;
    const [wasm, run] = [this.wasm, this.#live()];
    const text = (address) => textAt(wasm.memory, address);
    const argument = (i) => (wasm.failed_text(run, i) ? text(wasm.failed_text(run, i)) : wasm.failed_number(run, i));
    const values = Array.from({ length: wasm.failed_count(run) }, (_, i) => argument(i));
    const sentence = formatted(text(wasm.failed_sentence(run)), values);
    throw Object.assign(new SystemError(`${text(wasm.failed_component(run)) || subject}: ${sentence}`), { rows });
  }
}

function must(condition, sentence) {
  if (!condition) throw new SystemError(sentence);
}

function isCount(value) {
  return Number.isInteger(value) && value >= 0 && value < 2 ** 32;
}

/** The text of C at an address. */
function textAt(memory, address) {
  const bytes = new Uint8Array(memory.buffer, address);
  return address ? new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))) : "";
}

/** A sentence of printf, as C prints it: %s, %d, %u, and %g with or without a precision. */
export function formatted(sentence, values) {
  let next = 0;
  return sentence.replace(/%(?:\.(\d+))?[hlz]*([a-z%])/g, (_, digits = "6", conversion) => {
    if (conversion === "%") return "%";
    const value = values[next++];
    return conversion === "g" ? general(value, Math.max(1, digits)) : String(value);
  });
}

/** A number with p significant digits, as %g of C shows it: halves go to the even digit, last zeros are left out. */
function general(x, p) {
  if (!Number.isFinite(x)) return Number.isNaN(x) ? "nan" : x > 0 ? "inf" : "-inf";
  const parts = (n) => Math.abs(x).toExponential(n - 1).replace(".", "").split("e");
  let [digits, power] = parts(p);
  const [all, down] = parts(101);
  if (/^50*$/.test(all.slice(p)) && all[p - 1] % 2 === 0) [digits, power] = [all.slice(0, p), down];
  const e = Number(power);
  const scientific = e < -4 || e >= p;
  const lead = scientific ? 1 : Math.max(0, e + 1);
  const whole = digits.slice(0, lead) || "0";
  const rest = ((scientific || e >= 0 ? "" : "0".repeat(-e - 1)) + digits.slice(lead)).replace(/0*$/, "");
  const sign = x < 0 || Object.is(x, -0) ? "-" : "";
  const exponent = scientific ? `e${e < 0 ? "-" : "+"}${String(Math.abs(e)).padStart(2, "0")}` : "";
  return sign + whole + (rest && `.${rest}`) + exponent;
}
