// Colours for a quantity: from blue over violet to orange, which all eyes tell apart and which stand out on either ground.
import { html } from "../core/html.js";
import { colour } from "../ui/theme.js";

const STOPS = ["series-1", "series-4", "series-2"];
export const SHADES = 48;

/** So many colours from least to greatest. */
export function shades(count = SHADES) {
  const stops = STOPS.map((name) => rgbOf(colour(name)));
  return Array.from({ length: count }, (_, index) => {
    const along = (index / Math.max(count - 1, 1)) * (stops.length - 1);
    const from = Math.min(Math.floor(along), stops.length - 2);
    const mixed = stops[from].map((value, channel) => Math.round(value + (stops[from + 1][channel] - value) * (along - from)));
    return `rgb(${mixed.join(",")})`;
  });
}

const rgbOf = (hex) => [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16));

/** A function from values to places among the shades. */
export function shadeScale(values, count = SHADES) {
  const known = values.filter(Number.isFinite);
  const [low, high] = known.reduce(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
  const place = (value) => (Number.isFinite(value) ? Math.min(count - 1, Math.floor(((value - low) / (high - low || 1)) * count)) : 0);
  return { low, high, place, known: known.length > 0 };
}

/** What the colours mean. */
export const ShadeLegend = ({ name, low, high }) => html`<div class="shade-legend small"><span>${name}</span><span class="number">${low}</span><span class="shade-bar" aria-hidden="true"></span><span class="number">${high}</span></div>`;
