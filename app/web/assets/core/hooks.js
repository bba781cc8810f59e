// What pages share: data that is loaded, kept fresh and may fail.
import { KEY_SHOWN } from "./api.js";
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
  const reload = useCallback(() => setTurn((before) => before + 1), []);
  useEffect(() => {
    if (state.error?.status !== 401) return undefined;
    addEventListener(KEY_SHOWN, reload);
    return () => removeEventListener(KEY_SHOWN, reload);
  }, [state.error]);
  return { ...state, reload };
}

/** Something of which nothing may be lost: done for each that was given, one after the other; its error kept until the next is given. */
export function useEach(act) {
  const [error, setError] = useState(null);
  const last = useRef(Promise.resolve());
  const run = (...given) => {
    setError(null);
    last.current = last.current.then(() => act(...given)).catch(setError);
    return last.current;
  };
  return { error, run };
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
