// What pages share: data that is loaded, kept fresh and may fail.
import { useCallback, useEffect, useRef, useState } from "./html.js";

/**
 * Load something when the page shows and whenever `keys` change.
 * @param {(signal: AbortSignal) => Promise<any>} load
 * @param {unknown[]} keys
 * @returns {{data: any, error: Error | null, loading: boolean, reload: () => void}}
 */
export function useLoaded(load, keys) {
  const [state, setState] = useState({ data: null, error: null, loading: true });
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const controller = new AbortController();
    // What was asked for before may come after what is asked for now: it says nothing any more.
    const unlessOld = (change) => controller.signal.aborted || setState(change);
    setState((before) => ({ ...before, loading: true }));
    load(controller.signal).then(
      (data) => unlessOld({ data, error: null, loading: false }),
      (error) => unlessOld((before) => ({ ...before, error, loading: false })),
    );
    return () => controller.abort();
  }, [...keys, turn]);
  return { ...state, reload: useCallback(() => setTurn((before) => before + 1), []) };
}

/** Something that a button does: busy while it lasts, its error kept until the next try. */
export function useAction(act) {
  const [state, setState] = useState({ busy: false, error: null });
  const running = useRef(false);
  const run = async (...given) => {
    if (running.current) return undefined;
    running.current = true;
    setState({ busy: true, error: null });
    try {
      const result = await act(...given);
      setState({ busy: false, error: null });
      return result;
    } catch (error) {
      setState({ busy: false, error });
      return undefined;
    } finally {
      running.current = false;
    }
  };
  return { ...state, run };
}
