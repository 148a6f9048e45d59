/** Light and dark: what the system says until the reader chooses; and the colours of the theme in force. */

const CURVES = 7;

/** The value of a property of the style, such as ``ink``. @param {string} name */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Colour of a curve or a run, by its number. @param {number} place */
export const curveColour = (place) => colour(`curve-${(place % CURVES) + 1}`);

/** Let a button switch the theme; the page hears of it by the event ``theme``. @param {HTMLElement} button */
export function connectTheme(button) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const show = (/** @type {boolean} */ dark) => {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    button.setAttribute("aria-pressed", String(dark));
    document.dispatchEvent(new Event("theme"));
  };
  button.addEventListener("click", () => show(document.documentElement.dataset.theme !== "dark"));
  system.addEventListener("change", () => show(system.matches));
  show(system.matches);
}
