import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { store } from "../store.ts";

const close = (): void => store.set({ menu: null });

/** A dialog over the page: it keeps the focus, and gives it back to where it was. */
export function Dialog(
  { name, children, closed = close }:
  { name: string; children: ComponentChildren; closed?: () => void },
) {
  const box = useRef<HTMLDialogElement>(null);
  const before = useRef(document.activeElement);
  useEffect(() => {
    const dialog = box.current;
    dialog?.showModal();
    return () => {
      dialog?.close();
      if (before.current instanceof HTMLElement) before.current.focus();
    };
  }, []);
  return (
    <dialog class="dialog" ref={box} aria-label={name} onClose={closed}
      onClick={(event) => event.target === event.currentTarget && closed()}>
      <div>{children}</div>
    </dialog>
  );
}

/** Close what is open when the pointer or the focus goes elsewhere, and on Escape. */
export function useAway<E extends HTMLElement>(open: boolean, shut: () => void) {
  const box = useRef<E>(null);
  useEffect(() => {
    if (!open) return undefined;
    const away = (event: Event) => {
      // What has just been replaced, by a form that takes the focus, is not left: it is gone.
      if (box.current && !box.current.contains(event.target as Node)) shut();
    };
    const key = (event: KeyboardEvent) => {
      if (event.key !== "Escape") return;
      event.stopImmediatePropagation(); // Escape would also deselect
      shut();
    };
    addEventListener("pointerdown", away);
    addEventListener("focusin", away);
    addEventListener("keydown", key, true);
    return () => {
      removeEventListener("pointerdown", away);
      removeEventListener("focusin", away);
      removeEventListener("keydown", key, true);
    };
  }, [open]);
  return box;
}
