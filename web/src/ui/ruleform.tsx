// One rule of a draft: what it looks for, how bad that is, and when it is armed.

import { useRef } from "preact/hooks";
import { desk, useDesk } from "./desk.ts";
import { Entry } from "./entry.tsx";
import { Glyph, Icon } from "./icons.tsx";
import {
  withKey, withKind, withoutRule, type Key, type Kind, type OneKind, type Remark, type Rule,
} from "../state/draft.ts";
import { always, DAYS, readWeek, writeWeek, type Week } from "../state/schedule.ts";
import type { Severity } from "../state/messages.ts";
import { named, SEVERITY } from "../state/words.ts";

const SEVERITIES = Object.keys(SEVERITY).reverse() as Severity[];

/** Return what kinds of rules are called where people choose one. */
export const KIND_NAMES: Record<string, string> = {
  "zone.enter": "Somebody enters", "zone.exit": "Somebody leaves", "zone.dwell": "Stays too long",
  "zone.restricted": "Nobody may be inside", "line.cross": "Line crossed",
  "occupancy.limit": "Too many people", "density.level": "Too crowded",
  "speed.running": "Somebody runs", "flow.wrong_way": "Wrong way",
  "edge.platform": "Near or beyond the edge", "body.fall": "Somebody fell",
  "body.down": "Somebody lies on the floor", "body.climb": "Somebody climbs",
  "body.reach": "Somebody reaches in", "body.distress": "Somebody calls for help",
  "zone.confined": "Somebody leaves the allowed zone", "density.critical": "Dangerously crowded",
  "crowd.pressure": "Crowd turbulence", "flow.bottleneck": "Flow breaks down",
  "crowd.panic": "Several people run", "group.split": "Somebody is left alone",
  "ttc.vehicle": "Collision ahead", "access.tailgate": "Two with one access",
  "access.unauthorised": "Access without authorisation", "lift.unload": "Lift not unloaded",
};

export const kindName = (kind: string): string => KIND_NAMES[kind] ?? named(kind.replaceAll(".", " "));

export function RuleForm({ n, rule, at }: { n: number; rule: Rule; at: OneKind | null }) {
  const { kinds, mayEdit, remarks, faults } = useDesk();
  const kind = kinds.find((one) => one.name === rule.kind);
  const fits = kinds.filter((one) =>
    at === null ? one.place === null || one.place_is_optional : one.place === at);
  const severity = (rule.severity as Severity | undefined) ?? "warning";
  const set = (key: string, value: unknown) => desk.change(withKey(desk.parts, n, key, value), `rule ${n} ${key}`);
  const here = (list: readonly Remark[]) =>
    list.filter((one) => one.at[0] === "rules" && one.at[1] === n);
  return (
    <details class="rule" open={here(faults).length > 0 || undefined}>
      <summary>
        <Glyph severity={severity} />
        <b>{kindName(rule.kind)}</b><span class="id">{rule.id}</span>
      </summary>
      <fieldset disabled={!mayEdit}>
        <legend class="hidden">Rule {rule.id}</legend>
        <Remarks list={here(faults)} wrong />
        <Remarks list={here(remarks)} />
        <label class="row"><span>Kind</span>
          <select class="field" value={rule.kind} onChange={(event) => {
            const next = kinds.find((one) => one.name === event.currentTarget.value);
            if (next) desk.change(withKind(desk.parts, n, next));
          }}>
            {!kind && <option value={rule.kind}>{rule.kind}</option>}
            {(kind && !fits.includes(kind) ? [kind, ...fits] : fits).map((one) => (
              <option key={one.name} value={one.name}>{kindName(one.name)}</option>
            ))}
          </select>
        </label>
        {kind && <p class="about">{kind.about.replaceAll("`", "")}</p>}
        <label class="row"><span>Name</span>
          <Entry value={rule.id} pattern="[A-Za-z0-9_\-]{1,64}" required title="Letters, digits, - and _"
            commit={(text) => set("id", text.trim())} />
        </label>
        <label class="row"><span>Severity</span>
          <select class="field" value={severity}
            onChange={(event) => set("severity", event.currentTarget.value)}>
            {SEVERITIES.map((one) => <option key={one} value={one}>{SEVERITY[one]}</option>)}
          </select>
        </label>
        {kind?.keys.map((key) => <Field key={key.name} of={key} rule={rule} set={set} />)}
        {kind && <More kind={kind} rule={rule} set={set} />}
        <Schedule rule={rule} set={set} mayEdit={mayEdit} />
        {mayEdit && (
          <button type="button" class="button quiet" onClick={() => desk.change(withoutRule(desk.parts, n))}>
            <Icon name="trash" size={16} />Remove the rule
          </button>
        )}
      </fieldset>
    </details>
  );
}

function More({ kind, rule, set }: { kind: Kind; rule: Rule; set: (key: string, value: unknown) => void }) {
  const given = kind.common.some((key) => key.name in rule);
  return (
    <details class="more" open={given || undefined}>
      <summary>Delays and certainty</summary>
      {kind.common.map((key) => <Field key={key.name} of={key} rule={rule} set={set} />)}
    </details>
  );
}

const UNITS: [RegExp, string][] = [
  [/_mps$/, "m/s"], [/_pm2$/, "/m²"], [/_deg$/, "°"], [/_m$/, "m"], [/_s$/, "s"],
];
const WORDS: Record<string, string> = {
  p_on: "Certain enough from", p_off: "Over below", on_delay_s: "Must hold for",
  off_delay_s: "Gap before the end", cooldown_s: "Pause after an alert", early_s: "Early warning",
  dwell_s: "Longer than", limit: "From so many people", speed_mps: "Faster than",
  heading_deg: "Allowed heading", distance_m: "Near is", depth_m: "Width of the drop",
  direction: "Direction", level: "Level of service",
};

function Field(
  { of, rule, set }: { of: Key; rule: Rule; set: (key: string, value: unknown) => void },
) {
  const unit = UNITS.find(([pattern]) => pattern.test(of.name));
  const words = WORDS[of.name] ?? named(of.name.replace(unit?.[0] ?? /$^/, ""));
  const value = rule[of.name];
  const other = of.default === null || of.default === undefined ? "" : String(of.default);
  const about = of.about.replaceAll("`", "");
  if (of.type === "choice" || of.type === "flag") {
    const choices = of.type === "flag" ? ["true", "false"] : (of.choices ?? []);
    return (
      <label class="row" title={about}><span>{words}</span>
        <select class="field" value={value === undefined ? other : String(value)}
          onChange={(event) => {
            const text = event.currentTarget.value;
            const next = of.type === "flag" ? text === "true" : text;
            set(of.name, text === other && !of.required ? undefined : next);
          }}>
          {choices.map((one) => <option key={one} value={one}>{named(one)}</option>)}
        </select>
      </label>
    );
  }
  const isNumber = of.type === "number" || of.type === "integer";
  return (
    <label class="row" title={about}><span>{words}</span>
      <span class="unit">
        <Entry decimal={isNumber} placeholder={other} required={of.required}
          value={value === undefined ? "" : String(value)}
          pattern={isNumber ? "-?[0-9]*[.]?[0-9]+" : undefined}
          commit={(given) => {
            const text = given.trim();
            const number = Number(text);
            if (text === "") set(of.name, of.required ? value : undefined);
            else if (!isNumber) set(of.name, text);
            else if (Number.isFinite(number)) set(of.name, of.type === "integer" ? Math.round(number) : number);
          }} />
        {unit && <i>{unit[1]}</i>}
      </span>
    </label>
  );
}

/** What is wrong or doubtful about what is shown, in place. */
export function Remarks({ list, wrong = false }: { list: readonly Remark[]; wrong?: boolean }) {
  return (
    <>
      {list.map((one) => (
        <p key={one.text} class={`remark ${wrong ? "wrong" : ""}`} role={wrong ? "alert" : undefined}>
          <Glyph severity="warning" size={14} /><span>{one.text}</span>
        </p>
      ))}
    </>
  );
}

function Schedule(
  { rule, set, mayEdit }:
  { rule: Rule; set: (key: string, value: unknown) => void; mayEdit: boolean },
) {
  const painting = useRef<boolean | null>(null);
  const ranges = (rule.schedule as string[] | undefined) ?? null;
  const week = ranges === null ? always() : readWeek(ranges);
  if (!week) {
    return (
      <label class="row"><span>Armed</span>
        <Entry value={(ranges ?? []).join("; ")} commit={(text) => {
          const given = text.split(";").map((one) => one.trim()).filter(Boolean);
          set("schedule", given.length ? given : undefined);
        }} />
      </label>
    );
  }
  const paint = (day: number, hour: number, on: boolean) => {
    const next: Week = week.map((row, d) => row.map((was, h) => (d === day && h === hour ? on : was)));
    if (next.every((row) => row.every((one) => !one))) return; // a rule that is never armed is none
    set("schedule", writeWeek(next));
  };
  const begin = (day: number, hour: number) => {
    painting.current = !(week[day]?.[hour] ?? false);
    paint(day, hour, painting.current);
    const end = () => {
      painting.current = null;
      desk.settle();
      removeEventListener("pointerup", end);
    };
    addEventListener("pointerup", end);
  };
  return (
    <div class="week">
      <p class="soft">{ranges === null ? "Always armed." : `Armed ${ranges.join(", ")}.`}</p>
      <table aria-label="Hours in which the rule is armed">
        <tbody>
          {DAYS.map((day, d) => (
            <tr key={day}>
              <th scope="row">{day}</th>
              {Array.from({ length: 24 }, (_, h) => (
                <td key={h}>
                  <button type="button" class="hour" aria-pressed={week[d]?.[h] ?? false}
                    aria-label={`${day} ${h}:00`} tabIndex={h === 0 ? 0 : -1} disabled={!mayEdit}
                    onPointerDown={(event) => {
                      event.currentTarget.releasePointerCapture?.(event.pointerId);
                      begin(d, h);
                    }}
                    onPointerEnter={() => painting.current !== null && paint(d, h, painting.current)}
                    onKeyDown={(event) => hourKey(event, () => paint(d, h, !(week[d]?.[h] ?? false)))} />
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      <div class="scale" aria-hidden="true"><span>0</span><span>6</span><span>12</span><span>18</span><span>24 h</span></div>
      {ranges !== null && mayEdit && (
        <button type="button" class="button quiet" onClick={() => set("schedule", undefined)}>Always armed</button>
      )}
    </div>
  );
}

/** Arrows go from hour to hour, Space and Enter turn one over. */
function hourKey(event: KeyboardEvent, flip: () => void): void {
  const cell = (event.currentTarget as HTMLElement).parentElement;
  const row = cell?.parentElement;
  const at = cell && row ? [...row.querySelectorAll("td")].indexOf(cell as HTMLTableCellElement) : -1;
  const beside = (tr: Element | null | undefined, n: number) =>
    tr?.querySelectorAll<HTMLButtonElement>("td > button")[n]?.focus();
  const acts: Record<string, () => void> = {
    ArrowLeft: () => beside(row, at - 1), ArrowRight: () => beside(row, at + 1),
    ArrowUp: () => beside(row?.previousElementSibling, at),
    ArrowDown: () => beside(row?.nextElementSibling, at),
    " ": flip, Enter: flip,
  };
  const act = acts[event.key];
  if (!act) return;
  event.preventDefault();
  event.stopPropagation();
  act();
}
