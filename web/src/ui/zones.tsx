import { Icon, type IconName } from "./icons.tsx";
import { Plan } from "./planview.tsx";
import { useStore } from "./use.ts";
import type { Point } from "../state/site.ts";
import { named } from "../state/words.ts";
import { store } from "../store.ts";

const area = (polygon: readonly Point[]): number =>
  Math.abs(polygon.reduce((sum, a, i) => {
    const b = polygon[(i + 1) % polygon.length] as Point;
    return sum + a[0] * b[1] - b[0] * a[1];
  }, 0)) / 2;

const length = (points: readonly Point[]): number =>
  points.slice(1).reduce((sum, b, i) => {
    const a = points[i] as Point;
    return sum + Math.hypot(b[0] - a[0], b[1] - a[1]);
  }, 0);

export function Zones() {
  const { state, address } = useStore();
  const site = state.site;
  const zone = site?.zones.find((one) => one.name === address.subject);
  const path = [...(site?.lines ?? []), ...(site?.edges ?? [])]
    .find((one) => one.name === address.subject);
  return (
    <div class="zones">
      <section class="bar" aria-label="Version">
        <h2>Zones</h2><span class="tagged">Live version</span>
        <p>What is in force now. Zones and rules are written in the site file.</p>
      </section>
      <section class="names" aria-label="Zones, lines and edges">
        <Group title="Zones" icon="area" names={site?.zones.map((one) => one.name) ?? []} />
        <Group title="Lines" icon="line" names={site?.lines.map((one) => one.name) ?? []} />
        <Group title="Edges" icon="edge" names={site?.edges.map((one) => one.name) ?? []} />
      </section>
      <main class="plan" aria-label="Plan of the zones"><Plan large /></main>
      <aside class="form" aria-label="Selected">
        {zone && (
          <Sheet name={zone.name} rows={[
            ["Area", `${area(zone.polygon).toFixed(1)} m²`],
            ["Height", `${zone.z[0].toFixed(2)} to ${zone.z[1].toFixed(2)} m`],
            ["Corners", String(zone.polygon.length)],
          ]} />
        )}
        {path && <Sheet name={path.name} rows={[["Length", `${length(path.points).toFixed(2)} m`]]} />}
        {(site?.rules ?? 0) === 0 && (
          <div class="none">
            <strong>No rules yet</strong>
            <p>A rule says when someone in a zone, at an edge or over a line is an alert. Zones, lines, edges and rules are read from the site file.</p>
          </div>
        )}
      </aside>
    </div>
  );
}

function Sheet({ name, rows }: { name: string; rows: [string, string][] }) {
  return (
    <>
      <div class="head"><h2>{named(name)}</h2></div>
      <div class="block">
        <dl class="facts-list">
          {rows.map(([key, value]) => <div key={key}><dt>{key}</dt><dd>{value}</dd></div>)}
        </dl>
      </div>
    </>
  );
}

function Group({ title, icon, names }: { title: string; icon: IconName; names: string[] }) {
  const { address } = useStore();
  return (
    <>
      <h3>{title}</h3>
      {names.length === 0 && <p class="empty">None in the site file.</p>}
      {names.map((name) => (
        <button key={name} type="button" class="item"
          aria-current={address.subject === name ? "true" : undefined}
          onClick={() => store.go({ subject: name }, true)}>
          <Icon name={icon} size={16} /><b>{named(name)}</b><span />
        </button>
      ))}
    </>
  );
}
