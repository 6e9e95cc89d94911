// The zone editor: what is live, the draft beside it, its trial, and making it live.

import { useEffect, useState } from "preact/hooks";
import { desk, useDesk } from "./desk.ts";
import { Dialog, useAway } from "./dialog.tsx";
import { Glyph, Icon, type IconName } from "./icons.tsx";
import { Counts, TrialBox, TryButton } from "./trial.tsx";
import { useStore } from "./use.ts";
import { EverywhereForm, PlaceForm } from "./zoneform.tsx";
import { ZoneChecks } from "./zonechecks.tsx";
import { ZonePlan, type Tool } from "./zoneplan.tsx";
import {
  changes, everywhere, freeName, isArea, kindOf, ONE, PLACE_KINDS, rulesOf, withCorners, type PlaceKind,
} from "../state/draft.ts";
import type { Point } from "../state/site.ts";
import { getVersion, getVersions, type Version } from "../net/drafts.ts";
import { count, day, hourMinute, list, named } from "../state/words.ts";
import { store } from "../store.ts";
import "../styles/zones.css";

/** The subject that stands for rules about no place; no place can have this name. */
export const EVERYWHERE = "*";
const ICONS: Record<PlaceKind, IconName> = {
  zones: "area", lines: "line", edges: "edge", exclusions: "area", portals: "line",
};
const HEADS: Record<PlaceKind, string> = {
  zones: "Zones", lines: "Lines", edges: "Edges", exclusions: "Beds and benches", portals: "Portals",
};

export function Zones() {
  const { address, state } = useStore();
  const { parts, mayEdit, loaded, fault } = useDesk();
  const [tool, setTool] = useState<Tool>("select");
  useEffect(() => void desk.load(), [state.site?.version]);
  useKeys(setTool);
  const kind = kindOf(parts, address.subject);
  return (
    <div class="zones">
      <Bar />
      <section class="names" aria-label="Places">
        <div class="scroll">
          {PLACE_KINDS.map((of) => <Group key={of} of={of} />)}
          <Everywhere />
        </div>
        {mayEdit && <Add />}
      </section>
      <main class={`plan ${kind === "zones" ? "checked" : ""}`} aria-label="Plan of the zones">
        <div class="sheet"><ZonePlan tool={tool} setTool={setTool} /></div>
        {kind === "zones" && address.subject && <ZoneChecks name={address.subject} />}
      </main>
      <aside class="form" aria-label="Selected">
        <div class="scroll">
          {fault && <p class="note-page" role="alert">{fault}</p>}
          {kind && address.subject && <PlaceForm key={address.subject} kind={kind} name={address.subject} />}
          {address.subject === EVERYWHERE && <EverywhereForm />}
          {!kind && address.subject !== EVERYWHERE && loaded && <Nothing />}
        </div>
        <TrialBox />
      </aside>
    </div>
  );
}

function Nothing() {
  const { parts, mayEdit, hasFile } = useDesk();
  return (
    <div class="none">
      <strong>{hasFile && parts.rules.length === 0 ? "No rules yet" : "Nothing chosen"}</strong>
      <p>
        {mayEdit
          ? "Choose a zone, line or edge, or draw one on the plan. A rule says when someone in it is an alert."
          : hasFile
            ? "Choose a zone, line or edge. Only admins change them."
            : "Choose a zone, line or edge. They are those of the recording, and cannot be changed."}
      </p>
      <p>Rules are advisory: trecsim is no certified safety function.</p>
    </div>
  );
}

function useKeys(setTool: (tool: Tool) => void): void {
  useEffect(() => {
    const tools: Record<string, Tool> = { v: "select", z: "zones", i: "lines", d: "edges", b: "exclusions", p: "portals" };
    const pressed = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      if (target.closest("input, select, textarea, dialog") || !desk.mayEdit) return;
      const key = event.key.toLowerCase();
      if ((event.ctrlKey || event.metaKey) && key === "z") {
        event.preventDefault();
        if (event.shiftKey) desk.redo();
        else desk.undo();
      } else if (event.ctrlKey || event.metaKey || event.altKey) return;
      else if (tools[key]) setTool(tools[key]);
      else if (event.key === "Escape") {
        setTool("select");
        store.go({ subject: null }, true);
      }
    };
    addEventListener("keydown", pressed);
    return () => removeEventListener("keydown", pressed);
  }, []);
}

function Bar() {
  const { live, parts, keeping, mayEdit, isDraft, by, said, remarks } = useDesk();
  const [asks, setAsks] = useState(false);
  const changed = changes(live, parts);
  const told = changed.length === 0
    ? "What is in force now."
    : `${count(changed.length, "change")}: ${list(changed.slice(0, 3))}${changed.length > 3 ? " and more" : ""}. The live rules stay as they are.`;
  const fault = keeping === "wrong" || keeping === "conflict" || keeping === "failed" ? said : "";
  return (
    <section class="bar" aria-label="Version">
      <h2>Zones</h2>
      {isDraft
        ? <span class="tagged draft"><Icon name="pen" size={16} />Draft, not live</span>
        : <span class="tagged">Live version</span>}
      {fault
        ? <p class="wrong" role="alert"><Glyph severity="warning" size={14} />{keeping === "wrong" ? `Not kept: ${said}` : said}</p>
        : <p title={told}>{said || told}{isDraft && by && keeping === "kept" && by !== "local" ? ` Kept by ${by}.` : ""}</p>}
      <div class="end">
        {keeping === "conflict" && (
          <>
            <button type="button" class="button" onClick={() => void desk.load(true)}>Load theirs</button>
            <button type="button" class="button" onClick={() => void desk.overwrite()}>Keep mine</button>
          </>
        )}
        {mayEdit && keeping !== "conflict" && (
          <>
            {isDraft && <button type="button" class="button quiet" onClick={() => void desk.discard()}>Discard</button>}
            {!isDraft && <Earlier />}
            <TryButton />
            <button type="button" class="button primary" disabled={!isDraft || keeping === "wrong"}
              title={isDraft ? "" : "There is no draft"} onClick={() => setAsks(true)}>Make live</button>
          </>
        )}
      </div>
      {asks && <Ask changed={changed} doubts={remarks.length} done={() => setAsks(false)} />}
    </section>
  );
}

/** Take zones and rules of an earlier version of the site file as the draft. */
function Earlier() {
  const [open, setOpen] = useState(false);
  const [versions, setVersions] = useState<Version[] | null>(null);
  const box = useAway<HTMLDivElement>(open, () => setOpen(false));
  const zone = store.state.site?.timezone ?? "UTC";
  useEffect(() => {
    if (open) getVersions().then(setVersions, () => setVersions([]));
  }, [open]);
  const take = async (version: string) => {
    setOpen(false);
    try {
      const { zones, lines, edges, exclusions, portals, rules } = await getVersion(version);
      desk.change({ zones, lines, edges, exclusions, portals, rules });
    } catch (error) {
      store.toast(`Could not load it: ${error instanceof Error ? error.message : String(error)}`);
    }
  };
  return (
    <div class="try" ref={box}>
      <button type="button" class="button quiet" aria-haspopup="true" aria-expanded={open}
        onClick={() => setOpen(!open)}>Earlier versions</button>
      {open && (
        <div class="menu">
          {versions?.length === 0 && <p>None is kept: nothing was made live from this page yet.</p>}
          {versions?.slice(0, 12).map((one) => (
            <button key={one.until_s} type="button" onClick={() => void take(one.version)}>
              Live until {day(one.until_s, zone)}, {hourMinute(one.until_s, zone)}
            </button>
          ))}
        </div>
      )}
    </div>
  );
}

function Ask({ changed, doubts, done }: { changed: string[]; doubts: number; done: () => void }) {
  const { trial, said, keeping } = useDesk();
  return (
    <Dialog name="Make live" closed={done}>
      <h2>Make the draft live?</h2>
      <ul class="changed">{changed.map((one) => <li key={one}>{one}</li>)}</ul>
      {trial ? <Counts trial={trial} /> : <p>It has not been tried on a recording.</p>}
      {doubts > 0 && <p>{count(doubts, "remark")} on it, shown in place.</p>}
      <p>Rules change at once, without a restart. The version before is kept.</p>
      {(keeping === "wrong" || keeping === "conflict" || keeping === "failed") && <p class="fault" role="alert">{said}</p>}
      <div class="row">
        <button type="button" class="button primary" onClick={async () => {
          if (await desk.makeLive()) done();
        }}>Make live</button>
        <button type="button" class="button quiet" onClick={done}>Cancel</button>
      </div>
    </Dialog>
  );
}

function Group({ of }: { of: PlaceKind }) {
  const { address } = useStore();
  const { parts, faults, remarks } = useDesk();
  const names = Object.keys(parts[of]);
  const marked = new Set([...faults, ...remarks].filter((one) => one.at[0] === of).map((one) => one.at[1]));
  return (
    <>
      <h3>{HEADS[of]}</h3>
      {names.length === 0 && <p class="empty">None.</p>}
      {names.map((name) => (
        <button key={name} type="button" class="item"
          aria-current={address.subject === name ? "true" : undefined}
          onClick={() => store.go({ subject: name }, true)}>
          <Icon name={ICONS[of]} size={16} /><b>{named(name)}</b>
          <span class="end">
            {marked.has(name) ? <Glyph severity="warning" size={14} /> : null}
            {count(rulesOf(parts, of, name).length, "rule")}
          </span>
        </button>
      ))}
    </>
  );
}

function Everywhere() {
  const { address } = useStore();
  const { parts } = useDesk();
  return (
    <>
      <h3>Everywhere</h3>
      <button type="button" class="item" aria-current={address.subject === EVERYWHERE ? "true" : undefined}
        onClick={() => store.go({ subject: EVERYWHERE }, true)}>
        <Icon name="user" size={16} /><b>People</b>
        <span class="end">{count(everywhere(parts).length, "rule")}</span>
      </button>
    </>
  );
}

/** Add a place in the middle of the floor: without a pointer, too. */
function Add() {
  const add = (of: PlaceKind) => {
    const site = store.state.site;
    if (!site) return;
    const { low, high } = site.floor;
    const [x, y] = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2].map((v) => Math.round(v)) as [number, number];
    const shape: Point[] = isArea(of)
      ? [[x - 1, y - 1], [x + 1, y - 1], [x + 1, y + 1], [x - 1, y + 1]] : [[x - 1, y], [x + 1, y]];
    const name = freeName(desk.parts, of);
    desk.change(withCorners(desk.parts, of, name, shape));
    store.go({ subject: name }, true);
  };
  return (
    <div class="add">
      {PLACE_KINDS.map((of) => (
        <button key={of} type="button" class="button" onClick={() => add(of)}>
          <Icon name="add" size={16} />{of === "exclusions" ? "Bed" : named(ONE[of])}
        </button>
      ))}
    </div>
  );
}

