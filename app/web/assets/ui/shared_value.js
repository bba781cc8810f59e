// A value that charts and plans share, such as what is pointed at: they follow it without the page being made anew.
import { useEffect, useRef, useState } from "../core/html.js";

/** A value with listeners. Whoever sets it names itself, so that it need not follow its own change. */
export function sharedValue(first = null) {
  const listeners = new Set();
  let value = first;
  return {
    get: () => value,
    set(next, by = null) {
      if (next === value) return;
      value = next;
      for (const listener of listeners) listener(value, by);
    },
    /** @returns {() => void} an end to it */
    listen(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
  };
}

/** One for the life of a component. */
export function useShared(first = null) {
  const kept = useRef(null);
  kept.current ??= sharedValue(first);
  return kept.current;
}

/** The present value, for parts small enough to be made anew with each change. */
export function useValueOf(shared) {
  const [value, setValue] = useState(shared.get());
  useEffect(() => { setValue(shared.get()); return shared.listen(setValue); }, [shared]);
  return value;
}
