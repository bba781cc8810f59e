// The pages' colours as the drawing needs them, and when they change.
import { Color } from "/vendor/three.min.js";

const NAMES = { ground: "--ground", line: "--line", strongLine: "--strong-line", ink: "--ink", accent: "--accent", target: "--target", photo: "--photo", control: "--control", check: "--check" };
const SERIES = 6; // of style/tokens.css

/** Present colours by name; `series` are those of trajectories. */
export function palette() {
  const style = getComputedStyle(document.documentElement);
  const colour = (token) => new Color(style.getPropertyValue(token).trim());
  const named = Object.fromEntries(Object.entries(NAMES).map(([name, token]) => [name, colour(token)]));
  return { ...named, series: Array.from({ length: SERIES }, (_, index) => colour(`--series-${index + 1}`)) };
}

/**
 * Hear when the reader's colours change.
 * @param {() => void} onChange
 * @returns {() => void} stop
 */
export function onColours(onChange) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const chosen = new MutationObserver(onChange);
  system.addEventListener("change", onChange);
  chosen.observe(document.documentElement, { attributeFilter: ["data-theme"] });
  return () => { system.removeEventListener("change", onChange); chosen.disconnect(); };
}

/** A colour as it stands in the style sheet, for shaders that write what the screen shows. */
export const asShown = (colour) => colour.clone().convertLinearToSRGB();
