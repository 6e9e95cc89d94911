// The place that is chosen: its name, height and corners, and the rules about it.

import { useState } from "preact/hooks";
import { desk, useDesk } from "./desk.ts";
import { Entry } from "./entry.tsx";
import { Icon } from "./icons.tsx";
import { kindName, Remarks, RuleForm } from "./ruleform.tsx";
import {
  area, corners, everywhere, heights, isArea, isLine, least, length, ONE, renamed, rulesOf, withCorners,
  withHeights, without, withRule, type OneKind, type PlaceKind,
} from "../state/draft.ts";
import type { Point } from "../state/site.ts";
import { named } from "../state/words.ts";
import { store } from "../store.ts";

export function PlaceForm({ kind, name }: { kind: PlaceKind; name: string }) {
  const { parts, mayEdit, faults, remarks } = useDesk();
  const points = corners(parts, kind, name);
  const z = heights(parts[kind][name]);
  const here = faults.filter((one) => one.at[0] === kind && one.at[1] === name);
  const doubts = remarks.filter((one) => one.at[0] === kind && one.at[1] === name);
  const rename = (to: string) => {
    const next = renamed(desk.parts, kind, name, to.trim());
    if (next === desk.parts) return;
    desk.change(next);
    store.go({ subject: to.trim() }, true);
  };
  const remove = () => {
    desk.change(without(desk.parts, kind, name));
    store.go({ subject: null }, true);
  };
  return (
    <>
      <div class="block" key={`${kind} ${name}`}>
        <h2 class="hidden">{named(name)}</h2>
        <Remarks list={here} wrong />
        <Remarks list={doubts} />
        <fieldset disabled={!mayEdit}>
          <legend class="hidden">{named(ONE[kind])} {name}</legend>
          <label class="row"><span>Name</span>
            <Entry value={name} pattern="[A-Za-z0-9_\-]{1,64}" required
              title="Letters, digits, - and _" commit={rename} />
          </label>
          {isArea(kind) && (
            <div class="row" role="group" aria-label="Height">
              <span>Height</span>
              <Metres label="From" value={z[0]} set={(low) => desk.change(withHeights(desk.parts, kind, name, [low, z[1]]))} />
              <span>to</span>
              <Metres label="To" value={z[1]} set={(high) => desk.change(withHeights(desk.parts, kind, name, [z[0], high]))} />
            </div>
          )}
          {isLine(kind) && mayEdit && (
            <div class="row"><span>“In” is where the arrow points</span>
              <button type="button" class="button" onClick={() =>
                desk.change(withCorners(desk.parts, kind, name, [...points].reverse()))}>Turn round</button>
            </div>
          )}
          {kind === "edges" && mayEdit && (
            <div class="row"><span>The drop is where the teeth are</span>
              <button type="button" class="button" onClick={() =>
                desk.change(withCorners(desk.parts, kind, name, [...points].reverse()))}>Other side</button>
            </div>
          )}
          <Corners kind={kind} name={name} points={points} />
        </fieldset>
        <dl class="facts-list">
          <div>
            <dt>{isArea(kind) ? "Area" : "Length"}</dt>
            <dd>{isArea(kind) ? `${area(points).toFixed(1)} m²` : `${length(points).toFixed(2)} m`}</dd>
          </div>
        </dl>
      </div>
      {kind === "exclusions" && (
        <div class="block"><p class="empty">Lying in it is normal: rules on falls and on people who are down leave it out.</p></div>
      )}
      {kind === "portals" && (
        <div class="block"><p class="empty">The report of a day counts who comes and goes here.</p></div>
      )}
      {kind !== "exclusions" && kind !== "portals" && (
        <Rules of={rulesOf(parts, kind, name)} at={ONE[kind]} place={name} />
      )}
      {mayEdit && (
        <div class="block">
          <button type="button" class="button quiet" onClick={remove}>
            <Icon name="trash" size={16} />Remove {named(name)}
          </button>
        </div>
      )}
    </>
  );
}

export function EverywhereForm() {
  const { parts } = useDesk();
  return (
    <>
      <div class="head"><h2>Everywhere</h2></div>
      <Rules of={everywhere(parts)} at={null} place={null} />
    </>
  );
}

function Rules(
  { of, at, place }:
  { of: ReturnType<typeof everywhere>; at: OneKind | null; place: string | null },
) {
  const { mayEdit, kinds } = useDesk();
  const fits = kinds.filter((one) =>
    at === null ? one.place === null || one.place_is_optional : one.place === at);
  return (
    <section class="rules" aria-label="Rules">
      {of.length === 0 && (
        <p class="empty">{mayEdit ? "No rule. Without one, nothing here is an alert." : "No rule."}</p>
      )}
      {of.map(([n, rule]) => <RuleForm key={`${n} ${rule.id}`} n={n} rule={rule} at={at} />)}
      {mayEdit && fits.length > 0 && (
        <div class="block">
          <select class="field" aria-label="Add a rule" value=""
            onChange={(event) => {
              const kind = fits.find((one) => one.name === event.currentTarget.value);
              event.currentTarget.value = "";
              if (kind) desk.change(withRule(desk.parts, kind, place));
            }}>
            <option value="">Add a rule…</option>
            {fits.map((one) => <option key={one.name} value={one.name}>{kindName(one.name)}</option>)}
          </select>
        </div>
      )}
    </section>
  );
}

function Metres({ label, value, set }: { label: string; value: number; set: (value: number) => void }) {
  return (
    <span class="unit">
      <Entry decimal label={label} value={String(value)} pattern="-?[0-9]*[.]?[0-9]+"
        commit={(text) => {
          const next = Number(text);
          if (text.trim() !== "" && Number.isFinite(next)) set(next);
        }} />
      <i>m</i>
    </span>
  );
}

function Corners({ kind, name, points }: { kind: PlaceKind; name: string; points: Point[] }) {
  const [open, setOpen] = useState(false);
  const set = (n: number, axis: 0 | 1, value: number) => {
    const next = points.map((p, i): Point =>
      i !== n ? p : axis === 0 ? [value, p[1]] : [p[0], value]);
    desk.change(withCorners(desk.parts, kind, name, next));
  };
  return (
    <details class="more" open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>{points.length} {isArea(kind) ? "corners" : "points"}</summary>
      {open && points.map((p, n) => (
        <div class="row" key={n} role="group" aria-label={`Corner ${n + 1}`}>
          <span>{n + 1}</span>
          <Metres label={`x of corner ${n + 1}`} value={p[0]} set={(x) => set(n, 0, x)} />
          <Metres label={`y of corner ${n + 1}`} value={p[1]} set={(y) => set(n, 1, y)} />
          <button type="button" class="button quiet icon" aria-label={`Remove corner ${n + 1}`}
            disabled={points.length <= least(kind)}
            onClick={() => desk.change(withCorners(desk.parts, kind, name, points.filter((_, i) => i !== n)))}>
            <Icon name="close" size={16} />
          </button>
        </div>
      ))}
    </details>
  );
}
