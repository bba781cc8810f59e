// What the next build of a survey leaves out; kept while the tab is open, so that the report can add to it.
import { useEffect, useState } from "../core/html.js";

const NOTHING = { images: [], codes: [], control_points: [] };
const CHANGED = "scattermark:exclusion";
const keyOf = (surveyId) => `exclude ${surveyId}`;

/** @returns {{images: string[], codes: number[], control_points: string[]}} */
export const exclusionOf = (surveyId) => ({ ...NOTHING, ...JSON.parse(sessionStorage.getItem(keyOf(surveyId)) ?? "{}") });

/** Set all that is left out. */
export function setExclusion(surveyId, exclusion) {
  sessionStorage.setItem(keyOf(surveyId), JSON.stringify({ ...NOTHING, ...exclusion }));
  dispatchEvent(new CustomEvent(CHANGED));
}

/** How many things are left out. */
export const sizeOf = (exclusion) => exclusion.images.length + exclusion.codes.length + exclusion.control_points.length;

/**
 * What is left out, and a function that takes one thing out or in again: `change("codes", 389)`.
 * @param {string} surveyId
 */
export function useExclusion(surveyId) {
  const [exclusion, setState] = useState(() => exclusionOf(surveyId));
  useEffect(() => {
    const read = () => setState(exclusionOf(surveyId));
    read();
    addEventListener(CHANGED, read);
    return () => removeEventListener(CHANGED, read);
  }, [surveyId]);
  const change = (kind, item) => {
    const before = exclusionOf(surveyId);
    const without = before[kind].filter((other) => other !== item);
    setExclusion(surveyId, { ...before, [kind]: without.length < before[kind].length ? without : [...without, item] });
  };
  return [exclusion, change];
}
