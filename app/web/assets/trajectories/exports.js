// A trajectory as a file, as it was located or smoothed to a rate of one's own.
import { address, get } from "../core/api.js";
import { useAction } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { download, saveAs } from "../core/save.js";
import { Button, Failure, Field } from "../ui/parts.js";

const FORMATS = [
  ["csv", "CSV", "csv"], ["tum", "TUM", "tum"], ["kitti", "KITTI", "kitti"], ["kitti-times", "KITTI times", "times"], ["euroc", "EuRoC", "euroc.csv"],
  ["geojson", "GeoJSON", "geojson"], ["geopose", "GeoPose", "geopose.json"], ["evaal", "EvAAL", "evaal.csv"], ["json", "JSON", "json"],
];
const RATE_HZ = 10;
const MAX_GAP_S = 3; // as the service has it by default

export function Exports({ trajectory, times }) {
  const [smooth, setSmooth] = useState(false);
  const [rate_hz, setRate] = useState(RATE_HZ);
  const [max_gap_s, setGap] = useState(MAX_GAP_S);
  const saving = useAction(([format, , ending]) => {
    const path = `/trajectories/${trajectory.trajectory_id}${smooth ? "/smoothed" : ""}`;
    const parameters = { format, ...times, ...(smooth ? { rate_hz, max_gap_s } : {}) };
    const name = `${trajectory.name || trajectory.trajectory_id}${smooth ? "-smoothed" : ""}.${ending}`;
    return format === "json" && !smooth ? saveWhole(path, times, name) : download(address(path, parameters), name);
  });
  return html`<section class="card" aria-label="Export"><h2>Export</h2>
    <${Failure} error=${saving.error} />
    <div class="row exports">${FORMATS.map((format) => html`<${Button} disabled=${saving.busy} onClick=${() => saving.run(format)}>${format[1]}</${Button}>`)}</div>
    <label class="row smooth"><input type="checkbox" checked=${smooth} onChange=${(event) => setSmooth(event.target.checked)} /> Smoothed: also between the snapshots</label>
    ${smooth && html`<div class="columns"><${Field} label="Poses a second"><input type="number" min="0.1" max="1000" step="any" value=${rate_hz} onInput=${(event) => setRate(event.target.value)} /></${Field}>
      <${Field} label="Nothing across gaps longer than, s"><input type="number" min="0.1" max="60" step="any" value=${max_gap_s} onInput=${(event) => setGap(event.target.value)} /></${Field}></div>`}
  </section>`;
}

/** As JSON a trajectory comes page by page; the file holds all of them as one. */
async function saveWhole(path, times, name) {
  let [whole, cursor] = [null, null];
  do {
    const page = await get(address(path, { limit: 1000, ...times, cursor }));
    whole = { ...page, poses: [...(whole?.poses ?? []), ...page.poses], failures: [...(whole?.failures ?? []), ...page.failures] };
    cursor = page.next_cursor;
  } while (cursor);
  saveAs(new Blob([JSON.stringify(whole)], { type: "application/json" }), name);
}
