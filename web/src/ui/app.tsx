import { useEffect, useState } from "preact/hooks";
import type { ComponentType } from "preact";
import { Dialog } from "./dialog.tsx";
import { Help } from "./help.tsx";
import { Live } from "./live.tsx";
import { Login } from "./login.tsx";
import { Phone } from "./phone.tsx";
import { Rail } from "./rail.tsx";
import { Facts, StatusBlock } from "./top.tsx";
import { use, useStore } from "./use.ts";
import { clock, duration, hourMinute } from "../state/words.ts";
import { store } from "../store.ts";

const NARROW = matchMedia("(max-width: 719px)");

function useNarrow(): boolean {
  const [narrow, set] = useState(NARROW.matches);
  useEffect(() => {
    const tell = () => set(NARROW.matches);
    NARROW.addEventListener("change", tell);
    return () => NARROW.removeEventListener("change", tell);
  }, []);
  return narrow;
}

/** A page that is loaded when it is opened. */
function Later({ load }: { load: () => Promise<ComponentType> }) {
  const [Page, set] = useState<ComponentType | null>(null);
  const [fault, setFault] = useState(false);
  useEffect(() => {
    load().then((page) => set(() => page), () => setFault(true));
  }, []);
  if (fault) return <p class="note-page" role="alert">This part of the page was not loaded. Load the page again.</p>;
  return Page ? <Page /> : null;
}

const LATER = {
  review: () => import("./review.tsx").then((m) => m.Review),
  zones: () => import("./zones.tsx").then((m) => m.Zones),
  system: () => import("./system.tsx").then((m) => m.System),
};

export function App() {
  const access = use((s) => s.state.access);
  const page = use((s) => s.address.page);
  const narrow = useNarrow();
  if (access === "out") return <Login />;
  if (narrow) return <><Phone later={page === "live" ? null : <Later key={page} load={LATER[page]} />} /><Float /></>;
  return (
    <div class="frame">
      {page === "live" && <a class="button skip" href="#twin">People as a table</a>}
      <header class="top"><StatusBlock /><Facts /></header>
      <Rail />
      <div class="page">
        {page === "live" ? <Live /> : <Later key={page} load={LATER[page]} />}
      </div>
      <Float />
    </div>
  );
}

/** What floats over every page: toast, dialogs, and the words for those who listen. */
export function Float() {
  const shop = useStore();
  const { toast } = shop.own;
  const { back } = shop.state;
  return (
    <>
      <Announce />
      {back && !toast && (
        <div class="toast" role="status">
          Connected again. {duration(back.missed)} were missed
          {back.alerts ? `: ${back.alerts} ${back.alerts === 1 ? "alert" : "alerts"}.` : "."}
        </div>
      )}
      {toast && (
        <div class="toast" role="status">
          {toast.text}
          {toast.undo && <button type="button" class="button" onClick={toast.undo}>Undo</button>}
        </div>
      )}
      {shop.own.menu === "help" && <Help />}
      {shop.own.menu === "go to" && <GoTo />}
    </>
  );
}

/** Say each new alarm once. */
function Announce() {
  const said = use((s) => s.announcement);
  return <div class="hidden" role="alert">{said}</div>;
}

/** Go to a time of the last ten minutes. */
function GoTo() {
  const [text, set] = useState("");
  const [fault, setFault] = useState("");
  const go = (event: Event) => {
    event.preventDefault();
    const t = store.momentOf(text);
    if (t === null) setFault("Write a time as 14:32:08.");
    else if (t < store.history.from || t > store.history.to) {
      const zone = store.state.site?.timezone ?? "UTC";
      setFault(store.history.length === 0
        ? "This page has seen nothing yet."
        : `This page has seen ${hourMinute(store.history.from, zone)} to ${hourMinute(store.history.to, zone)}. Review has older recordings.`);
    } else {
      store.set({ menu: null, playing: false });
      store.replay(t);
    }
  };
  return (
    <Dialog name="Go to a time">
      <form onSubmit={go}>
        <h2>Go to a time</h2>
        <input class="field" autoFocus value={text} aria-label="Time" aria-describedby="goto-fault"
          placeholder={clock(store.history.to, store.state.site?.timezone ?? "UTC")}
          onInput={(event) => set(event.currentTarget.value)} />
        <p id="goto-fault" class="fault" role="alert">{fault}</p>
        <div class="row">
          <button type="submit" class="button primary">Go</button>
          <button type="button" class="button quiet" onClick={() => store.set({ menu: null })}>Cancel</button>
        </div>
      </form>
    </Dialog>
  );
}
