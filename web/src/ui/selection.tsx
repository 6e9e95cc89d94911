import { Icon, MarkIcon } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { concerned } from "./shown.ts";
import { useStore } from "./use.ts";
import { drawFigure } from "../draw/figure.ts";
import { fit } from "../draw/mark.ts";
import { palette } from "../draw/palette.ts";
import { slotOf } from "../state/marks.ts";
import {
  leastSure, nearest, positionSigma, seenBy, zoneAt, type Person,
} from "../state/people.ts";
import { count, duration, named, plusMinus } from "../state/words.ts";
import { store, type Store } from "../store.ts";

const STATES = { provisional: "Not yet confirmed", confirmed: "Confirmed", coasting: "Not seen" };
const POSTURES: Record<string, string> = {
  upright: "Upright", low: "Low", lying: "Lying", unknown: "Unknown",
};

/** Return what the panel says of a person: name and value of each row. */
export function rows(shop: Store, person: Person): [string, string][] {
  const site = shop.state.site;
  const t = shop.shown?.t ?? NaN;
  const v = person.velocity ?? shop.film.velocity(person.id, t);
  const near = site ? nearest(person, site.edges, site.zones) : null;
  const zone = site ? zoneAt(site.zones, person.floor) : null;
  const least = leastSure(person);
  const since = t - shop.film.since(person.id);
  return [
    ["Speed", v ? `${Math.hypot(v[0], v[1]).toFixed(1)} m/s` : "Unknown"],
    ["Posture", POSTURES[person.posture ?? "unknown"] ?? "Unknown"],
    zone
      ? ["In", named(zone)]
      : near
        ? [near.kind === "edge" ? "To edge" : `To ${named(near.name)}`, `${near.metres.toFixed(2)} m`]
        : ["At", `${person.floor[0].toFixed(1)}, ${person.floor[1].toFixed(1)} m`],
    ["Seen by", count(seenBy(person), "camera")],
    ["Position", plusMinus(positionSigma(person))],
    ["Least sure", least ? `${least.joint} ${plusMinus(least.sigma)}` : "Unknown"],
    ["Here for", Number.isFinite(since) ? duration(since) : "Unknown"],
  ];
}

export function Selection() {
  const shop = useStore();
  const id = shop.address.person;
  if (id === null) return null;
  const person = shop.shown?.people.find((one) => one.id === id);
  const slot = slotOf(shop.slots, id);
  const unseen = person && person.state === "coasting" && Number.isFinite(person.unseen)
    ? ` for ${duration(person.unseen)}` : "";
  return (
    <section class={`selection ${person ? "" : "gone"}`} aria-label={`Person ${id}`}>
      <div class="head">
        <span class="name"><MarkIcon slot={slot} size={16} /><b>{id}</b></span>
        <span class="note">{person ? STATES[person.state] + unseen : "Left"}</span>
        <div class="end">
          <button type="button" class="button quiet icon" aria-label="Follow" title="Follow (T)"
            aria-pressed={shop.address.view === "follow"}
            onClick={() => store.go({ view: shop.address.view === "follow" ? "overview" : "follow" })}>
            <Icon name="follow" />
          </button>
          <button type="button" class="button quiet icon" aria-label="Deselect" title="Deselect (Esc)"
            onClick={() => store.go({ person: null }, true)}>
            <Icon name="close" />
          </button>
        </div>
      </div>
      {person ? (
        <div class="body">
          <Drawn label={`Joints of person ${id} and how well each is known`} draw={figure} />
          <dl class="facts-list">
            {rows(shop, person).map(([name, value]) => (
              <div key={name}><dt>{name}</dt><dd>{value}</dd></div>
            ))}
          </dl>
        </div>
      ) : <p class="empty">Person {id} is not here now.</p>}
    </section>
  );
}

function figure(canvas: HTMLCanvasElement): void {
  const sheet = fit(canvas);
  const person = store.shown?.people.find((one) => one.id === store.address.person);
  if (!sheet || !person) return;
  const c = palette();
  const slot = slotOf(store.slots, person.id);
  const ink = concerned().alarmed.has(person.id)
    ? c.bodyAlarm
    : person.state === "provisional" ? c.bodyProvisional : (c.marks[slot - 1] ?? c.body);
  drawFigure(sheet.pen, c, sheet.width, sheet.height, person, ink);
}
