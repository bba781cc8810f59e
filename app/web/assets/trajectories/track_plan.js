// A trajectory seen from above: coloured by time or by its uncertainty, among the targets.
import { html, useMemo } from "../core/html.js";
import { drawTargets } from "../plan/draw.js";
import { Plan } from "../plan/plan.js";
import { ShadeLegend, SHADES, shades, shadeScale } from "../plan/shades.js";
import { drawDots, drawWay } from "../plan/track.js";
import { boundsOf } from "../plan/view.js";
import { mm, time } from "../core/format.js";
import { useValueOf } from "../ui/shared_value.js";
import { colour } from "../ui/theme.js";
import { worstSigma } from "./poses.js";

const COLOURINGS = {
  time: { value: (pose) => pose.time_s, name: "Time", text: (value) => time(new Date(value * 1000).toISOString()) },
  sigma: { value: worstSigma, name: "Largest σ", text: (value) => mm(value) },
};

/** @param {"time" | "sigma"} by what colours tell */
export function TrackPlan({ poses, gap_s, by, room, pointer, range }) {
  const chosen = useValueOf(range);
  const points = useMemo(() => poses.map((pose) => pose.position_m), [poses]);
  const bounds = useMemo(() => boundsOf([...points, ...room.targets.map((target) => target.position_m)]), [points, room]);
  const { value, name, text } = COLOURINGS[by];
  const scale = useMemo(() => shadeScale(poses.map(value)), [poses, by]);
  const shadeOf = (index) => {
    const pose = poses[index];
    if (chosen && (pose.time_s < chosen[0] || pose.time_s > chosen[1])) return -1;
    return scale.place(value(pose));
  };
  const draw = (context, view) => {
    drawTargets(context, view, room.targets, room.plate_u_m);
    drawWay(context, view, points, (index) => poses[index].time_s - poses[index - 1].time_s > gap_s, colour("strong-line"));
    drawDots(context, view, points, shadeOf, shades(SHADES));
  };
  return html`<${Plan} label=${`Plan of ${poses.length} poses`} bounds=${bounds} draw=${draw} keys=${[poses, by, gap_s, room, chosen]} points=${points} pointer=${pointer} />
    ${scale.known ? html`<${ShadeLegend} name=${name} low=${text(scale.low)} high=${text(scale.high)} />` : html`<p class="small muted">This trajectory tells no uncertainty.</p>`}`;
}
