// The chosen zone as the cameras see it that see most of it: does it lie where it is meant?

import { useEffect } from "preact/hooks";
import { useDesk } from "./desk.ts";
import { Icon } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { useStore } from "./use.ts";
import { usePicture } from "../net/picture.ts";
import { toCamera, toPixel } from "../draw/lens.ts";
import { fit } from "../draw/mark.ts";
import { palette } from "../draw/palette.ts";
import { drawTile } from "../draw/tile.ts";
import { corners, heights } from "../state/draft.ts";
import type { Camera, Point } from "../state/site.ts";
import { named } from "../state/words.ts";
import { store } from "../store.ts";

/** Return how many corners of a zone a camera has in its picture, and how near it is. */
function score(camera: Camera, polygon: readonly Point[]): number {
  const within = polygon.filter(([x, y]) => {
    const q = toCamera(camera.lens.T, x, y, 0);
    if (q[2] < 0.2) return false;
    const [u, v] = toPixel(camera.lens, q);
    return u > 0 && v > 0 && u < camera.lens.width && v < camera.lens.height;
  }).length;
  const [x, y] = polygon[0] ?? [0, 0];
  return within - 0.01 * Math.hypot(camera.at[0] - x, camera.at[1] - y);
}

export function ZoneChecks({ name }: { name: string }) {
  const { state } = useStore();
  const { parts } = useDesk();
  const polygon = corners(parts, "zones", name);
  const z = heights(parts.zones[name]);
  const best = [...(state.site?.cameras ?? [])]
    .sort((a, b) => score(b, polygon) - score(a, polygon)).slice(0, 2)
    .filter((camera) => score(camera, polygon) > 0);
  useEffect(() => store.draw(), [parts, name]);
  return (
    <section class="zonechecks" aria-label="The zone as cameras see it">
      {best.map((camera) => <Check key={camera.name} camera={camera} polygon={polygon} z={z} />)}
      {best.length === 0 && <p>No camera has a corner of this zone in its picture.</p>}
    </section>
  );
}

function Check(
  { camera, polygon, z }:
  { camera: Camera; polygon: readonly Point[]; z: readonly [number, number] },
) {
  const { state } = useStore();
  const picture = usePicture(camera.name, state.site?.pictures === true);
  return (
    <figure>
      <div class="picture">
        {picture && <img src={picture} alt="" />}
        <Drawn label={`Zone in the picture of camera ${named(camera.name)}`} draw={(canvas) => {
          const sheet = fit(canvas);
          const site = store.state.site;
          if (!sheet || !site) return;
          sheet.pen.clearRect(0, 0, sheet.width, sheet.height);
          drawTile(sheet.pen, palette(), sheet.width, sheet.height, {
            site: { ...site, zones: [] }, camera, snapshot: store.shown, alarmed: new Map(),
            selected: null, picture: picture !== "", prism: { polygon, z },
          });
        }} />
      </div>
      <figcaption>
        <Icon name="camera" size={16} /><b>{named(camera.name)}</b>
        <span>Does the outline lie where you mean it?</span>
      </figcaption>
    </figure>
  );
}
