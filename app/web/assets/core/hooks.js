// What pages share: data that is loaded, kept fresh and may fail.
import { KEY_SHOWN, laterOf } from "./api.js";
import { useCallback, useEffect, useRef, useState } from "./html.js";

/**
 * Load something when the page shows and whenever `keys` change. A full server is asked again when it says so, and after another
 * key was shown what had been refused for the want of one.
 * @param {(signal: AbortSignal) => Promise<any>} load
 * @param {unknown[]} keys
 * @returns {{data: any, error: Error | null, loading: boolean, later: boolean, reload: () => void}} `later`: the server was full
 */
export function useLoaded(load, keys) {
  const [state, setState] = useState({ data: null, error: null, loading: true, later: false });
  const [turn, setTurn] = useState(0);
  const reload = useCallback(() => setTurn((before) => before + 1), []);
  useEffect(() => {
    const controller = new AbortController();
    let timer = 0;
    // What was asked for before may come after what is asked for now: it says nothing any more.
    const unlessOld = (change) => controller.signal.aborted || setState(change);
    setState((before) => ({ ...before, loading: true }));
    load(controller.signal).then(
      (data) => unlessOld({ data, error: null, loading: false, later: false }),
      (error) => {
        const pause_s = laterOf(error);
        if (pause_s && !controller.signal.aborted) timer = setTimeout(reload, 1000 * pause_s);
        unlessOld((before) => (pause_s ? { ...before, later: true } : { ...before, error, loading: false, later: false }));
      },
    );
    return () => { controller.abort(); clearTimeout(timer); };
  }, [...keys, turn]);
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
