// What was seen in each photograph, asked for one after the other as they arrive; a full server is asked again.
import { FULL, Problem, Unreachable, get } from "../core/api.js";
import { useEffect, useState } from "../core/html.js";

const AGAIN_AFTER_MS = 2000;

/**
 * @param {string} surveyId
 * @param {string[]} names
 * @returns {{found: Map<string, object>, failed: Map<string, Error>}} detections, and those that cannot be had
 */
export function useDetections(surveyId, names) {
  const [state, setState] = useState({ found: new Map(), failed: new Map() });
  useEffect(() => {
    const controller = new AbortController();
    let timer = 0;
    const keep = (where, name, value) => setState((before) => ({ ...before, [where]: new Map(before[where]).set(name, value) }));
    const waiting = names.filter((name) => !state.found.has(name) && !state.failed.has(name));
    const ask = async () => {
      while (waiting.length) {
        const name = waiting[0];
        try {
          keep("found", name, await get(`/surveys/${surveyId}/images/${encodeURIComponent(name)}/detection`, { signal: controller.signal }));
        } catch (error) {
          if (error.name === "AbortError") return;
          if (error instanceof Unreachable || (error instanceof Problem && FULL.includes(error.status))) { timer = setTimeout(ask, AGAIN_AFTER_MS); return; }
          keep("failed", name, error);
        }
        waiting.shift();
      }
    };
    ask();
    return () => { controller.abort(); clearTimeout(timer); };
  }, [surveyId, names.join("\n")]);
  return state;
}
