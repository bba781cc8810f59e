// With which options an evaluation was made, for people.

const plain = (value, unit = "") => (value === null ? "none" : `${value}${unit}`);

/** Pairs of a name and a value. */
export const optionsText = ({ association, alignment, time_offset_s, lever_arm_m, floor_height_m, zones, bootstrap }) => [
  ["Association", `${association.association}, gaps up to ${association.max_gap_s} s, ${association.course}`],
  ["Clock offset", time_offset_s === null ? "estimated" : `${time_offset_s} s`],
  ["Alignment", alignment.alignment === "first_n" ? `first ${alignment.first_n} pairs` : `${alignment.alignment}${alignment.alignment === "none" ? "" : `, rotation from ${alignment.rotation_from}`}`],
  ["Lever arm", lever_arm_m ? `${lever_arm_m.join(", ")} m (right, down, forward)` : "none"],
  ["Storey height", plain(floor_height_m, " m")],
  ["Zones", zones.length ? zones.map((zone) => zone.name).join(", ") : "none"],
  ["Intervals", `${100 * bootstrap.confidence} %, ${bootstrap.resamples} resamples${bootstrap.block ? ` of blocks of ${bootstrap.block}` : ""}`],
];
