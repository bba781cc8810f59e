// x, y, z and heading over time, each with the band of two standard deviations, and the strip of gaps and failures.
import { html, useMemo } from "../core/html.js";
import { Chart } from "../ui/chart.js";
import { colour } from "../ui/theme.js";
import { gapsOf } from "./poses.js";

const SIGMAS = 2;
const DEG = 180 / Math.PI;
const YEAR_S = 3.15e7; // stamps below count from a start of their own
const POINTS_BELOW = 200; // poses: so few are shown one by one
const STRIP_PX = 84;
const SERIES_PX = 150;

const QUANTITIES = [
  { name: "x", unit: "m", value: (pose) => pose.position_m[0], sigma: (pose) => pose.sigma_m?.[0] },
  { name: "y", unit: "m", value: (pose) => pose.position_m[1], sigma: (pose) => pose.sigma_m?.[1] },
  { name: "z", unit: "m", value: (pose) => pose.position_m[2], sigma: (pose) => pose.sigma_m?.[2] },
  { name: "heading", unit: "°", value: (pose) => pose.heading_rad && pose.heading_rad * DEG, sigma: (pose) => pose.heading_sigma_rad * DEG },
];

/** All charts of a track, one time axis for all. */
export function Series({ poses, failures, gap_s, pointer, range }) {
  const shown = QUANTITIES.filter((quantity) => poses.some((pose) => Number.isFinite(quantity.value(pose))));
  return html`<section class="card" aria-label="Over time"><div class="row spread"><h2>Over time</h2><p class="small muted">Bands: ±${SIGMAS} σ. Drag to look closer, double-click for all.</p></div>
    <${Strip} poses=${poses} failures=${failures} gap_s=${gap_s} pointer=${pointer} range=${range} />
    ${shown.map((quantity) => html`<${Quantity} key=${quantity.name} quantity=${quantity} poses=${poses} gap_s=${gap_s} pointer=${pointer} range=${range} />`)}
  </section>`;
}

/** A calendar where stamps count from 1970; seconds where they count from a start of their own. */
export function timeScale(times_s) {
  return { x: { time: (times_s[0] ?? 0) > YEAR_S } };
}

function Quantity({ quantity, poses, gap_s, pointer, range }) {
  const data = useMemo(() => {
    const values = poses.map((pose) => quantity.value(pose) ?? null);
    const sigmas = poses.map((pose) => quantity.sigma(pose));
    const edge = (sign) => values.map((value, row) => (value === null || !Number.isFinite(sigmas[row]) ? null : value + sign * SIGMAS * sigmas[row]));
    return [poses.map((pose) => pose.time_s), edge(1), edge(-1), values];
  }, [poses]);
  const make = () => {
    const stroke = colour("accent");
    const gaps = (chart, series, first, last) => breaks(chart, series, first, last, gap_s, quantity.unit === "°");
    const edge = { stroke: "transparent", width: 0, points: { show: false }, gaps };
    return {
      axes: [{ show: false }, { label: `${quantity.name}, ${quantity.unit}`, labelSize: 18, labelFont: "12px system-ui, sans-serif", size: 46 }],
      scales: timeScale(data[0]),
      series: [{}, edge, edge, { stroke, width: 1.5, points: { show: poses.length < POINTS_BELOW, size: 4, fill: stroke }, gaps }],
      bands: [{ series: [1, 2], fill: `${stroke}40` }],
      padding: [6, 28, 6, 0],
    };
  };
  return html`<${Chart} label=${`${quantity.name} over time`} data=${data} make=${make} keys=${[gap_s, poses.length < POINTS_BELOW, timeScale(data[0]).x.time]} height_px=${SERIES_PX} pointer=${pointer} range=${range} />`;
}

/** Where a line breaks, as pairs of pixels: at gaps, and where a heading passes from 180° to -180°. */
function breaks(chart, series, first, last, gap_s, turning) {
  const [times, values] = [chart.data[0], chart.data[series]];
  const found = [];
  for (let row = Math.max(first, 1); row <= last; row += 1) {
    const turned = turning && Math.abs(values[row] - values[row - 1]) > 180;
    if (times[row] - times[row - 1] > gap_s || turned) found.push([Math.floor(chart.valToPos(times[row - 1], "x", true)), Math.ceil(chart.valToPos(times[row], "x", true)) + 1]);
  }
  return found;
}

/** When there were poses, when snapshots failed, when there was nothing. */
function Strip({ poses, failures, gap_s, pointer, range }) {
  const times = useMemo(() => poses.map((pose) => pose.time_s), [poses]);
  const make = () => ({
    axes: [{}, { show: true, values: () => [], ticks: { show: false }, grid: { show: false }, size: 46, label: " ", labelSize: 18 }],
    scales: { ...timeScale(times), y: { range: [0, 1] } },
    series: [{}, { stroke: "transparent", points: { show: false } }],
    hooks: { draw: [(chart) => drawStrip(chart, poses, failures, gap_s)] },
    padding: [6, 28, 0, 0],
  });
  const data = useMemo(() => [times, times.map(() => null)], [times]);
  return html`<${Chart} label=${stripText(poses, failures, gap_s)} data=${data} make=${make} keys=${[poses, failures, gap_s]} height_px=${STRIP_PX} pointer=${pointer} range=${range} />
    <p class="strip-key small muted"><span><i class="key-pose"></i>pose</span><span><i class="key-failure"></i>failure</span><span><i class="key-gap"></i>gap, longer than ${gap_s.toFixed(1)} s</span></p>`;
}

const stripText = (poses, failures, gap_s) => `${poses.length} poses, ${failures.length} failures, ${gapsOf(poses, gap_s).length} gaps over time`;

function drawStrip(chart, poses, failures, gap_s) {
  const { ctx: context, bbox } = chart;
  const at = (time_s) => chart.valToPos(time_s, "x", true);
  const bar = (left, width, share, from) => context.fillRect(left, bbox.top + bbox.height * from, width, bbox.height * share);
  context.save();
  context.beginPath();
  context.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  context.clip();
  context.fillStyle = colour("warn-soft");
  for (const [first, last] of gapsOf(poses, gap_s)) bar(at(first), at(last) - at(first), 1, 0);
  const tick = Math.max(1, devicePixelRatio);
  context.fillStyle = colour("accent");
  let before = -1;
  for (const pose of poses) {
    const left = Math.round(at(pose.time_s));
    if (left !== before) bar(left, tick, 0.4, 0.5);
    before = left;
  }
  context.fillStyle = colour("bad");
  for (const failure of failures) bar(Math.round(at(failure.time_s)) - tick, 2 * tick, 0.35, 0.05);
  context.restore();
}

