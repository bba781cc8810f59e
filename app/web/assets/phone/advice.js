// What is missing when a picture was not located: the service's reason and figures in few words, as one reads them while walking.
import { plural } from "../core/format.js";

/**
 * @typedef {object} Advice
 * @property {string} headline what was seen, and what to do
 * @property {boolean} camera whether it is the camera that the service does not know
 */

/** @param {object} problem as the service told it @returns {Advice} */
export function adviceFor(problem) {
  const make = BY_REASON[problem.reason];
  if (make) return { headline: make(figuresOf(problem)), camera: problem.reason === "unknown-camera" };
  return { headline: BY_KIND[problem.type?.split("/").pop()] ?? problem.title ?? "Not located", camera: false };
}

/** How many targets were read, and how many things looked like one and were not. */
function figuresOf({ seen }) {
  const targets = seen?.targets ?? [];
  return { read: targets.length, known: targets.filter((target) => target.reason !== "unknown-target").length, unread: (seen?.rejected ?? []).length };
}

const seenText = (count) => `${plural(count, "target")} seen`;

const BY_REASON = {
  "no-targets": ({ unread }) => (unread ? "No target could be read: move closer, hold still" : "0 targets seen: turn towards the targets, or step back"),
  "unknown-targets": ({ read }) => `${seenText(read)}, none of this site: is this the right place?`,
  "too-few-dots": ({ known }) => `${seenText(known)}: move closer, or turn until more are in view`,
  ambiguous: ({ known }) => `${seenText(known)}, too flat to tell: bring two or more into view, or move closer`,
  "unknown-camera": ({ read }) => `${seenText(read)}, but this camera is not known: calibrate it, or take a photograph`,
  inconsistent: ({ known }) => `${seenText(known)}, and they do not agree: hold still and try again`,
  "outside-site": ({ known }) => `${seenText(known)}, but the position is far outside: is this the right place?`,
};

const BY_KIND = {
  conflict: "The service cannot take this picture now",
  "not-found": "The service does not know this any more",
  "photo-too-large": "The picture is larger than the service takes",
  "bad-photo": "The picture cannot be read",
  "unsupported-photo": "The service does not read this kind of picture",
};
