// The picture's frame with all targets of all photographs in it: where the lens is known, and where nothing fell yet.
import { html } from "../core/html.js";
import { Badge } from "../ui/parts.js";
import { checksOf, cornersOf, measuresOf, usable } from "./measures.js";

/**
 * @param {object} given
 * @param {Array<object>} given.detections what was seen in each photograph, as the service tells it
 * @param {string | null} given.picked name of the photograph whose targets stand out
 */
export function Coverage({ detections, picked }) {
  const photos = usable(detections);
  const measures = measuresOf(photos);
  return html`<section class="card coverage" aria-label="What the set shows"><h2>What the set shows</h2>
    <${Frame} photos=${photos} measures=${measures} picked=${picked} />
    <ul class="checks">${checksOf(measures).map(({ name, good, text }) => html`<li key=${name}><${Badge} kind=${good ? "good" : photos.length ? "warn" : "off"}>${good ? "good" : photos.length ? "lacking" : "wanted"}</${Badge}><p><b>${name}</b><br />${text}</p></li>`)}</ul></section>`;
}

function Frame({ photos, measures, picked }) {
  const { width_px, height_px } = photos[0] ?? { width_px: 4, height_px: 3 };
  const [columns, rows] = [measures.cells[0].length, measures.cells.length];
  const empty = measures.cells.flatMap((row, y) => row.map((dots, x) => ({ x, y, dots }))).filter((cell) => !cell.dots);
  const label = photos.length ? `Where targets fell: ${Math.round(100 * measures.cover)} % of the picture hold dots` : "No target fell into the picture yet";
  return html`<svg class="frame" viewBox=${`0 0 ${width_px} ${height_px}`} role="img" aria-label=${label}>
    ${empty.map(({ x, y }) => html`<rect key=${`${x} ${y}`} class="hole" x=${(x * width_px) / columns} y=${(y * height_px) / rows} width=${width_px / columns} height=${height_px / rows} />`)}
    ${photos.map((photo) => html`<g key=${photo.name} class=${photo.name === picked ? "plates picked" : "plates"}>${photo.targets.map((target) => html`<polygon key=${target.code} points=${cornersOf(target).map((corner) => corner.join(",")).join(" ")} />`)}</g>`)}
  </svg>
  <p class="small muted frame-key"><span class="key-plate" aria-hidden="true"></span> a target <span class="key-hole" aria-hidden="true"></span> nothing yet${photos.length > 0 && html` · ${width_px} × ${height_px} px, as the sensor lies`}</p>`;
}
