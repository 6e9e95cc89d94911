import type { ComponentChildren } from "preact";
import { acknowledge, replay } from "./card.tsx";
import { Glyph, Icon, type IconName } from "./icons.tsx";
import { Plan } from "./planview.tsx";
import { Tile, bestView } from "./tiles.tsx";
import { behind, StatusIcon } from "./top.tsx";
import { useStore } from "./use.ts";
import { figures, handling, isFault, where, type Alert } from "../state/alerts.ts";
import type { Page } from "../state/address.ts";
import { counted } from "../state/people.ts";
import { dataTime, open, statusOf } from "../state/state.ts";
import { clock, count, named, whole } from "../state/words.ts";
import { store, type Store } from "../store.ts";

export function Phone({ later }: { later: ComponentChildren }) {
  const shop = useStore();
  return (
    <div class="phone">
      <header><Head shop={shop} /></header>
      {later ? <main>{later}</main> : <Glance shop={shop} />}
      <Tabs shop={shop} />
    </div>
  );
}

function Head({ shop }: { shop: Store }) {
  const { state } = shop;
  const status = statusOf(state);
  const site = state.site;
  return (
    <div class={`status ${status.look} ${status.severity ?? ""}`} data-row={status.row}>
      <div class="line">
        <span>{site ? named(site.name) : ""}{site?.mode ? `, ${site.mode} mode` : ""}</span>
        <b>{site ? clock(dataTime(state), site.timezone) : ""}</b>
      </div>
      <div class="said">
        <StatusIcon status={status} size={42} />
        <div role="status"><h1>{status.title}</h1></div>
      </div>
    </div>
  );
}

function Glance({ shop }: { shop: Store }) {
  const { state } = shop;
  const now = dataTime(state);
  const alerts = open(state);
  const first = alerts.find((alert) => handling(alert, now) !== "shelved");
  const best = bestView(state);
  const site = state.site;
  const camera = site?.cameras.find((one) => one.name === best?.name)
    ?? site?.cameras.find((one) => state.health?.cameras[one.name]?.state === "live")
    ?? site?.cameras[0];
  const people = state.snapshot ? counted(state.snapshot) : undefined;
  return (
    <main>
      {shop.replaying && (
        <div class="replaybar">
          <Icon name="review" />Replay <time>{clock(shop.time, site?.timezone ?? "UTC")}</time>
          <button type="button" class="button" onClick={() => store.go({ t: null }, true)}>Back to live</button>
        </div>
      )}
      <About shop={shop} alert={first ?? null} now={now} people={people} />
      {site && <section class="planbox" aria-label="Plan"><div class="body"><Plan large={false} /></div></section>}
      {camera && (
        <Tile camera={camera} state={state} best={best?.name === camera.name ? best.severity : null} tagged />
      )}
      <Rows shop={shop} />
    </main>
  );
}

function About(
  { shop, alert, now, people }:
  { shop: Store; alert: Alert | null; now: number; people: number | undefined },
) {
  const { state } = shop;
  const status = statusOf(state);
  const real = alert ? figures(alert, state.site?.cameras.length ?? 0) : [];
  const ack = alert && shop.mayAct && state.link !== "lost"
    && ["new", "ended"].includes(handling(alert, now));
  return (
    <section class="about">
      <p>{status.line || (alert ? where(alert, now) : "")}</p>
      <p>
        {people === undefined
          ? "People unknown."
          : `${people === 0 ? "Nobody is" : count(people, "person", "people")} here, ${behind(state)}.`}
      </p>
      {real.length > 0 && (
        <dl class="real">
          {real.map((one) => <div key={one.words}><dt>{one.value}</dt><dd>{one.words}</dd></div>)}
        </dl>
      )}
      {alert && (ack || alert.start >= shop.history.from) && !alert.part && (
        <div class="acts">
          {ack && (
            <button type="button" class="button primary" onClick={() => acknowledge([alert])}>Acknowledge</button>
          )}
          <button type="button" class="button" onClick={() => replay(alert)}><Icon name="play" />Replay</button>
        </div>
      )}
      {alert?.part && ack && (
        <div class="acts">
          <button type="button" class="button" onClick={() => acknowledge([alert])}>Acknowledge</button>
        </div>
      )}
    </section>
  );
}

function Rows({ shop }: { shop: Store }) {
  const { state } = shop;
  if (state.link === "lost" || !state.health) {
    return <ul class="rows"><li><Icon name="camera" />Cameras<span class="end">Unknown</span></li></ul>;
  }
  const cameras = Object.entries(state.health.cameras);
  const bad = cameras.filter(([, camera]) => isFault(camera.state));
  const good = cameras.filter(([, camera]) => camera.state === "live").length;
  return (
    <ul class="rows">
      {bad.map(([name, camera]) => (
        <li key={name} class="fault">
          <Glyph severity="warning" size={20} />Camera {named(name)}
          <span class="end">
            {camera.age_s === null ? "No picture yet" : `No picture, ${whole(camera.age_s)}`}
          </span>
        </li>
      ))}
      <li><Icon name="camera" />{bad.length ? "Other cameras" : "Cameras"}<span class="end">{cameras.length ? `${good} live` : "None yet"}</span></li>
    </ul>
  );
}

function Tabs({ shop }: { shop: Store }) {
  const tab = (page: Page, name: string, icon: IconName) => (
    <button type="button" aria-current={shop.address.page === page ? "page" : undefined}
      onClick={() => store.page(page)}>
      <Icon name={icon} size={22} />{name}
    </button>
  );
  const { sound, mutedUntil } = shop.own;
  const muted = mutedUntil > shop.state.local;
  return (
    <nav class="tabs" aria-label="Pages">
      {tab("live", "Live", "live")}
      {tab("review", "Review", "review")}
      <button type="button" aria-pressed={sound}
        onClick={() => (sound && !muted
          ? store.set({ mutedUntil: shop.state.local + 300 })
          : store.set({ sound: true, mutedUntil: 0 }))}>
        <Icon name={sound && !muted ? "sound" : "mute"} size={22} />
        {sound ? (muted ? "Muted" : "Mute") : "Sound off"}
      </button>
    </nav>
  );
}
