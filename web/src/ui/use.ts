import { useEffect, useRef, useState } from "preact/hooks";
import { store, type Store } from "../store.ts";

/** Return a part of the store; the component is drawn anew when that part changes. */
export function use<T>(select: (store: Store) => T): T {
  const [, again] = useState(0);
  const value = select(store);
  const last = useRef(value);
  last.current = value;
  const chosen = useRef(select);
  chosen.current = select;
  useEffect(
    () =>
      store.subscribe(() => {
        if (!Object.is(chosen.current(store), last.current)) again((n) => n + 1);
      }),
    [],
  );
  return value;
}

/** Draw the component anew whenever anything changes, at most four times a second. */
export function useStore(): Store {
  const [, again] = useState(0);
  useEffect(() => store.subscribe(() => again((n) => n + 1)), []);
  return store;
}
