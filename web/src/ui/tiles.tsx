import { Glyph, Icon } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { concerned, shownAlerts } from "./shown.ts";
import { useStore } from "./use.ts";
import { usePicture } from "../net/picture.ts";
import { isFault } from "../state/alerts.ts";
import { fit } from "../draw/mark.ts";
import { palette } from "../draw/palette.ts";
import { drawTile, isUpright } from "../draw/tile.ts";
import { toCamera, toPixel } from "../draw/lens.ts";
import type { CameraHealth, Severity } from "../state/messages.ts";
import type { Camera } from "../state/site.ts";
import { dataTime, type State } from "../state/state.ts";
import { hourMinute, named, whole } from "../state/words.ts";
import { store } from "../store.ts";

/** Return the camera that sees most of the person of the first open alert. */
export function bestView(state: State): { name: string; severity: Severity } | null {
  const alert = shownAlerts().find((one) => one.people.length > 0);
  if (!alert) return null;
  const person = store.shown?.people.find((one) => one.id === alert.people[0]);
  const site = state.site;
  if (!person || !site) return null;
  const score = (camera: Camera): number => {
    const live = store.replaying || !isFault(state.health?.cameras[camera.name]?.state ?? "down");
    if (!live) return -1;
    const q = toCamera(camera.lens.T, person.floor[0], person.floor[1], 1);
    if (q[2] < 0.3) return -1;
    const [u, v] = toPixel(camera.lens, q);
    const within = u > 0 && v > 0 && u < camera.lens.width && v < camera.lens.height;
    const told = alert.cameras.length === 0 || alert.cameras.includes(camera.name);
    return within && told ? camera.lens.fx / q[2] : -1;
  };
  const best = [...site.cameras].sort((a, b) => score(b) - score(a))[0];
  return best && score(best) > 0 ? { name: best.name, severity: alert.severity } : null;
}

/** Return the cameras in the order of their tiles: best view, faults, then by name. */
function ordered(state: State, best: string | null): Camera[] {
  const rank = (camera: Camera): number =>
    camera.name === best ? 0 : isFault(state.health?.cameras[camera.name]?.state ?? "") ? 1 : 2;
  const site = state.site?.cameras ?? [];
  const few = site.length <= places();
  return [...site].sort((a, b) =>
    (few ? 0 : rank(a) - rank(b)) || a.name.localeCompare(b.name, undefined, { numeric: true }));
}

const places = (): number => (window.innerWidth >= 1600 ? 6 : 4);

export function Tiles() {
  const { state } = useStore();
  const best = bestView(state);
  const cameras = ordered(state, best?.name ?? null);
  const fits = cameras.length <= places() ? cameras.length : places() - 1;
  const rest = cameras.slice(fits);
  return (
    <section class="tiles" aria-label="Cameras">
      {cameras.length === 0 && state.health && (
        <p>No camera is known yet. They come with the site file and its rig.</p>
      )}
      {cameras.slice(0, fits).map((camera) => (
        <Tile key={camera.name} camera={camera} state={state}
          best={best?.name === camera.name ? best.severity : null} />
      ))}
      {rest.length > 0 && (
        <button type="button" class="tile rest" onClick={() => store.page("system")}
          title={rest.map((camera) => named(camera.name)).join(", ")}>
          +{rest.length}
        </button>
      )}
    </section>
  );
}

export type TileState = "live" | "stale" | "down" | "ended" | "old" | "waiting" | "replay";

export function tileState(state: State, health: CameraHealth | undefined): TileState {
  if (store.address.page === "review" || store.replaying) return "replay";
  if (state.link === "lost") return "old";
  if (!health) return "waiting";
  return health.state;
}

export function Tile(
  { camera, state, best, tagged = false }:
  { camera: Camera; state: State; best: Severity | null; tagged?: boolean },
) {
  const health = state.health?.cameras[camera.name];
  const how = tileState(state, health);
  const asks = state.site?.pictures === true && !["replay", "down", "old"].includes(how);
  const picture = usePicture(camera.name, asks);
  const view = () => store.go({ view: `camera:${camera.name}` });
  return (
    <button type="button" class={`tile ${how} ${isUpright(camera) ? "upright" : ""}`} data-camera={camera.name} onClick={view}
      aria-label={`Camera ${named(camera.name)}, ${how}`}>
      <div class="picture">
        {how !== "down" && <Picture camera={camera} picture={picture} />}
        <Age state={state} health={health} how={how} />
        {best && (
          <span class={`tag best ${best}`}>
            <Glyph severity={best} size={14} reversed />
            {tagged ? `${named(camera.name)}, best view` : "Best view"}
          </span>
        )}
        {!best && how === "live" && isOddClock(state, health) && (
          <span class="tag"><Icon name="clock" size={14} />Clock unknown</span>
        )}
      </div>
      <div class="caption">
        {isFault(how) ? <Glyph severity="warning" /> : <Icon name="camera" size={16} />}
        <b>{named(camera.name)}</b>
        {!picture && (how === "live" || how === "replay") && <span class="drawn">drawn</span>}
        <span class="end">{word(how, health)}</span>
      </div>
    </button>
  );
}

/** Tell whether this camera's clock is unknown while others' are known. System tells it of all. */
function isOddClock(state: State, health: CameraHealth | undefined): boolean {
  const all = Object.values(state.health?.cameras ?? {});
  return state.site?.recording === false && health?.clock === "arrival"
    && all.some((camera) => camera.clock === "sender");
}

function word(how: TileState, health: CameraHealth | undefined): string {
  const words: Record<Exclude<TileState, "live">, string> = {
    stale: "Stale", down: "Down", ended: "Ended", old: "Unknown", waiting: "", replay: "",
  };
  return how === "live" ? `${(health?.fps ?? 0).toFixed(0)} fps` : words[how];
}

function Age(
  { state, health, how }: { state: State; health: CameraHealth | undefined; how: TileState },
) {
  const passed = state.local - state.heardAt;
  if (how === "old") {
    return Number.isFinite(passed)
      ? <div class="age"><strong>{whole(passed)}</strong><span>old</span></div>
      : <div class="age"><span class="said">Unknown</span></div>;
  }
  if (how === "stale") {
    const age = (health?.age_s ?? 0) + Math.max(0, passed || 0);
    return (
      <div class="age">
        <Icon name="nocamera" size={28} />
        <strong>{age < 100 ? `${age.toFixed(1)} s` : whole(age)}</strong>
        <span>since the last picture</span>
      </div>
    );
  }
  if (how !== "down") return null;
  const since = health?.age_s == null
    ? "No picture yet"
    : `Down since ${hourMinute(dataTime(state) - health.age_s, state.site?.timezone ?? "UTC")}`;
  return (
    <div class="age">
      <Icon name="nocamera" size={28} />
      <span class="said">{since}</span>
      <span>{health?.fault ?? "It is tried again every few seconds."}</span>
    </div>
  );
}

function Picture({ camera, picture }: { camera: Camera; picture: string }) {
  return (
    <>
      {picture && <img alt="" src={picture} />}
      <Drawn
        label={`What camera ${named(camera.name)} sees, drawn`}
        draw={(canvas) => {
          const sheet = fit(canvas);
          const site = store.state.site;
          if (!sheet || !site) return;
          drawTile(sheet.pen, palette(), sheet.width, sheet.height, {
            site, camera, snapshot: store.shown, alarmed: concerned().alarmed,
            selected: store.address.person, picture: picture !== "",
          });
        }}
      />
    </>
  );
}
