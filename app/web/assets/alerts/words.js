// Alerts in a few words.
import { html } from "../core/html.js";
import { number } from "../core/format.js";
import { Badge } from "../ui/parts.js";

const TITLES = {
  "moved-target": ({ code, displacement }) => html`Target ${code} stands <span class="number">${number(displacement.distance_mm, 1)} ± ${number(displacement.sigma_mm, 1)} mm</span> off`,
  "misfit-target": ({ code }) => `Target ${code} fits its place no more`,
  "vanished-target": ({ code }) => `Target ${code} is not seen any more`,
  "unknown-target": ({ code }) => `Target ${code} is not in the map`,
  "map-misfit": () => "The map as a whole fits worse",
};
const SEVERITIES = { critical: ["poses suffer", "bad"], warning: ["warning", "warn"], notice: ["notice", "info"] };
const STATES = { acknowledged: ["known", "off"], resolved: ["over", "good"] };

export const titleOf = (alert) => TITLES[alert.kind](alert);

/** How bad it is while it stands; how it stands. */
export function Signs({ alert }) {
  const severity = alert.state !== "resolved" && SEVERITIES[alert.severity];
  const state = STATES[alert.state];
  return html`${severity && html`<${Badge} kind=${severity[1]}>${severity[0]}</${Badge}>`} ${state && html`<${Badge} kind=${state[1]}>${state[0]}</${Badge}>`}`;
}
