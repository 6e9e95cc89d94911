// The floor plan on which zones, lines and edges are drawn and moved.

import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { desk, useDesk } from "./desk.ts";
import { Icon, type IconName } from "./icons.tsx";
import { Drawn } from "./planview.tsx";
import { planInput } from "./shown.ts";
import { useStore } from "./use.ts";
import { fit } from "../draw/mark.ts";
import { palette } from "../draw/palette.ts";
import { drawPlan, planView, type PlanView } from "../draw/plan.ts";
import {
  area, corners, crosses, distance, drafted, freeName, isArea, isLine, kindOf, least, middle, most,
  PLACE_KINDS, snap, withCorners, type Parts, type PlaceKind,
} from "../state/draft.ts";
import type { Point, Site } from "../state/site.ts";
import { named } from "../state/words.ts";
import { store } from "../store.ts";

export type Tool = "select" | PlaceKind;

const TOOLS: [Tool, string, string, string][] = [
  ["select", "Select", "V", "select"], ["zones", "Zone", "Z", "area"],
  ["lines", "Line", "I", "line"], ["edges", "Edge", "D", "edge"],
  ["exclusions", "Bed", "B", "area"], ["portals", "Portal", "P", "line"],
];
const MARGIN = 56;
const NEAR_PX = 12;
const HINTS: Record<Tool, string> = {
  select: "Drag a corner, or a ring to add one. Shift: straight. Alt: no grid. Delete removes it.",
  zones: "Click the corners. Click the first one again, or press Enter, to close the zone.",
  lines: "Click both ends. The arrow shows the direction “in”.",
  exclusions: "Click the corners of a bed or bench: lying there is no alert. Enter closes it.",
  portals: "Click both ends of a way in and out. The arrow points into the site.",
  edges: "Click along the edge, the drop on the left. Enter ends it.",
};

/** What is dragged: a corner, or a whole place from where it was taken. */
type Drag =
  | { corner: number; from: Point[] }
  | { corner: null; from: Point[]; at: Point };

export function ZonePlan({ tool, setTool }: { tool: Tool; setTool: (tool: Tool) => void }) {
  const shop = useStore();
  const { parts, mayEdit } = useDesk();
  const box = useRef<HTMLDivElement>(null);
  const [size, setSize] = useState<[number, number]>([0, 0]);
  useLayoutEffect(() => {
    if (!box.current) return undefined;
    const watch = new ResizeObserver(([entry]) =>
      entry && setSize([entry.contentRect.width, entry.contentRect.height]));
    watch.observe(box.current);
    return () => watch.disconnect();
  }, []);
  const site = shop.state.site;
  useEffect(() => store.draw(), [parts, shop.address.subject, size[0], size[1]]);
  const view = site && size[0] > 0 ? planView(site, size[0], size[1], MARGIN) : null;
  return (
    <div class="planedit" ref={box}>
      <Drawn label="Floor plan" draw={(canvas) => {
        const input = planInput(true);
        const sheet = fit(canvas);
        if (!input || !sheet) return;
        const chosen = store.address.subject;
        const kind = kindOf(desk.parts, chosen);
        const rest: Parts = kind && desk.mayEdit
          ? { ...desk.parts, [kind]: omit(desk.parts[kind], chosen ?? "") } : desk.parts;
        drawPlan(sheet.pen, palette(), sheet.width, sheet.height, MARGIN, {
          ...input, site: drafted(input.site, rest), chosen,
          layers: { ...input.layers, forecasts: false, zones: true }, heat: null,
        });
      }} />
      {view && site && <Sketch view={view} site={site} size={size} tool={tool} setTool={setTool} />}
      {mayEdit && <Tools tool={tool} setTool={setTool} />}
      {mayEdit && <p class="hint">{HINTS[tool]}</p>}
    </div>
  );
}

const omit = <T,>(tables: Readonly<Record<string, T>>, name: string): Record<string, T> =>
  Object.fromEntries(Object.entries(tables).filter(([key]) => key !== name));

function Tools({ tool, setTool }: { tool: Tool; setTool: (tool: Tool) => void }) {
  const { canUndo, canRedo } = useDesk();
  return (
    <div class="tools">
      <div class="segments" role="group" aria-label="Tool">
        {TOOLS.map(([key, name, letter, icon]) => (
          <button key={key} type="button" aria-pressed={tool === key} title={`${name} (${letter})`}
            class={key === "select" ? "square" : ""}
            aria-label={key === "select" ? "Select" : undefined} onClick={() => setTool(key)}>
            <Icon name={icon as IconName} size={16} />{key !== "select" && name}
          </button>
        ))}
      </div>
      <div class="segments" role="group" aria-label="Undo">
        <button type="button" class="square" aria-label="Undo" title="Undo (Ctrl+Z)"
          disabled={!canUndo} onClick={() => desk.undo()}><Icon name="undo" size={16} /></button>
        <button type="button" class="square" aria-label="Redo" title="Redo (Shift+Ctrl+Z)"
          disabled={!canRedo} onClick={() => desk.redo()}><Icon name="redo" size={16} /></button>
      </div>
    </div>
  );
}

interface SketchProps {
  view: PlanView;
  site: Site;
  size: [number, number];
  tool: Tool;
  setTool: (tool: Tool) => void;
}

function Sketch({ view, size, tool, setTool }: SketchProps) {
  const shop = useStore();
  const { parts, mayEdit } = useDesk();
  const svg = useRef<SVGSVGElement>(null);
  const drag = useRef<Drag | null>(null);
  const [hand, setHand] = useState<number | null>(null);
  const [begun, setBegun] = useState<Point[]>([]);
  const [pointer, setPointer] = useState<Point | null>(null);
  const chosen = shop.address.subject;
  const kind = kindOf(parts, chosen);
  const shape = kind && chosen ? corners(parts, kind, chosen) : [];
  const finish = useRef<() => void>(() => undefined);

  const at = (event: PointerEvent | MouseEvent): Point => {
    const area_ = svg.current?.getBoundingClientRect();
    return view.from([event.clientX - (area_?.left ?? 0), event.clientY - (area_?.top ?? 0)]);
  };
  const put = (points: readonly Point[], merge: string) => {
    if (kind && chosen) desk.change(withCorners(parts, kind, chosen, points), merge);
  };
  const create = (of: PlaceKind, points: readonly Point[]) => {
    setBegun([]);
    if (points.length < least(of)) return;
    const name = freeName(desk.parts, of);
    desk.change(withCorners(desk.parts, of, name, points));
    setTool("select");
    store.go({ subject: name }, true);
  };
  finish.current = () => tool !== "select" && create(tool, begun);

  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      if (begun.length === 0) return;
      if (event.key === "Enter") finish.current();
      else if (event.key === "Escape") setBegun([]);
      else if (event.key === "Backspace") setBegun(begun.slice(0, -1));
      else return;
      event.preventDefault();
      event.stopImmediatePropagation();
    };
    addEventListener("keydown", pressed, true);
    return () => removeEventListener("keydown", pressed, true);
  }, [begun]);
  useEffect(() => setBegun([]), [tool]);

  const draws = mayEdit && tool !== "select";
  const down = (event: PointerEvent) => {
    if (event.button !== 0) return;
    if (!draws) {
      if (event.target === svg.current) store.go({ subject: null }, true);
      return;
    }
    event.preventDefault();
    const last = begun.at(-1) ?? null;
    const point = snap(at(event), event.altKey, event.shiftKey ? last : null);
    const first = begun[0];
    const closes = first && begun.length >= least(tool)
      && distance(view.to(first), view.to(point)) < NEAR_PX;
    if (closes || (last && begun.length >= least(tool) && distance(last, point) < 1e-6)) {
      create(tool, begun);
      return;
    }
    const next = [...begun, point];
    if (next.length >= most(tool)) create(tool, next);
    else setBegun(next);
  };
  const move = (event: PointerEvent) => {
    const point = at(event);
    if (draws) setPointer(snap(point, event.altKey, event.shiftKey ? (begun.at(-1) ?? null) : null));
    const held = drag.current;
    if (!held) return;
    if (held.corner === null) {
      const [dx, dy] = snap([point[0] - held.at[0], point[1] - held.at[1]], event.altKey, null);
      put(held.from.map(([x, y]): Point => [x + dx, y + dy]), `move ${chosen}`);
    } else {
      const before = held.from[(held.corner - 1 + held.from.length) % held.from.length] ?? null;
      const to = snap(point, event.altKey, event.shiftKey ? before : null);
      put(held.from.map((p, i) => (i === held.corner ? to : p)), `corner ${chosen} ${held.corner}`);
    }
  };
  const up = () => {
    drag.current = null;
    desk.settle();
  };
  const take = (event: PointerEvent, corner: number | null, from: Point[]) => {
    if (!mayEdit || tool !== "select" || event.button !== 0) return;
    event.stopPropagation();
    svg.current?.setPointerCapture(event.pointerId);
    drag.current = corner === null ? { corner, from, at: at(event) } : { corner, from };
    setHand(corner);
  };
  const split = (event: PointerEvent, after: number) => {
    const next = [...shape];
    next.splice(after + 1, 0, snap(at(event), event.altKey, null));
    put(next, `corner ${chosen} ${after + 1}`);
    take(event, after + 1, next);
  };
  const nudge = (event: KeyboardEvent, corner: number) => {
    const ways: Record<string, Point> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    };
    const way = ways[event.key];
    if (event.key === "Delete" || event.key === "Backspace") {
      event.preventDefault();
      event.stopPropagation();
      if (kind && shape.length > least(kind)) put(shape.filter((_, i) => i !== corner), "");
      return;
    }
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    const step = event.shiftKey ? 1 : 0.1;
    // As on the screen: the plan may lie turned.
    const [x, y] = shape[corner] as Point;
    const [a, b] = [view.from([0, 0]), view.from([way[0], -way[1]])];
    const turned: Point = [(b[0] - a[0]) * view.scale, (b[1] - a[1]) * view.scale];
    put(shape.map((p, i): Point => (i === corner ? [x + turned[0] * step, y + turned[1] * step] : p)),
      `nudge ${chosen} ${corner}`);
  };

  return (
    <svg class={`sketch ${draws ? "draws" : ""}`} ref={svg} width={size[0]} height={size[1]}
      role="group" aria-label="Zones, lines and edges on the plan"
      onPointerDown={down} onPointerMove={move} onPointerUp={up} onPointerCancel={up}
      onDblClick={() => finish.current()}>
      {!draws && PLACE_KINDS.flatMap((of) => Object.keys(parts[of]).map((name) => (
        <Target key={`${of} ${name}`} view={view} kind={of} points={corners(parts, of, name)}
          down={(event) => {
            event.stopPropagation();
            if (name !== chosen) store.go({ subject: name }, true);
            take(event, null, corners(parts, of, name));
          }} />
      )))}
      {kind && shape.length > 0 && mayEdit && (
        <Chosen view={view} kind={kind} name={chosen ?? ""} points={shape} hand={hand}
          handles={!draws} take={(event, i) => take(event, i, shape)} split={split}
          nudge={nudge} setHand={setHand} />
      )}
      {begun.length > 0 && (
        <g class="begun">
          <path d={path(view, pointer ? [...begun, pointer] : begun, false)} />
          {begun.map((p, i) => <Square key={i} at={view.to(p)} size={i === 0 ? 13 : 10} full={i === 0} />)}
          {pointer && <Coordinates at={view.to(pointer)} point={pointer} />}
        </g>
      )}
    </svg>
  );
}

const path = (view: PlanView, points: readonly Point[], closed: boolean): string =>
  points.map((p, i) => {
    const [x, y] = view.to(p);
    return `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`;
  }).join("") + (closed ? "z" : "");

/** Where a press chooses a place, or takes it along. */
function Target(
  { view, kind, points, down }:
  { view: PlanView; kind: PlaceKind; points: Point[]; down: (event: PointerEvent) => void },
) {
  const closed = isArea(kind);
  return <path class={`target ${closed ? "closed" : ""}`} d={path(view, points, closed)}
    onPointerDown={down} />;
}

interface ChosenProps {
  view: PlanView;
  kind: PlaceKind;
  name: string;
  points: Point[];
  hand: number | null;
  handles: boolean;
  take: (event: PointerEvent, corner: number) => void;
  split: (event: PointerEvent, after: number) => void;
  nudge: (event: KeyboardEvent, corner: number) => void;
  setHand: (corner: number | null) => void;
}

function Chosen({ view, kind, name, points, hand, handles, take, split, nudge, setHand }: ChosenProps) {
  const closed = isArea(kind);
  const wrong = closed && crosses(points);
  const sides = points.map((p, i): [Point, Point, number] =>
    [p, points[(i + 1) % points.length] as Point, i]).slice(0, closed ? undefined : -1);
  const centre = view.to(middle(points));
  return (
    <g class={`chosen ${wrong ? "wrong" : ""}`}>
      <path class={closed ? "area" : "way"} d={path(view, points, closed)} />
      {kind === "edges" && <path class="teeth" d={teeth(view, points)} />}
      {isLine(kind) && <path class="arrow" d={arrow(view, points)} />}
      {closed && (
        <g class="label">
          <text x={centre[0]} y={centre[1] - 4} class="name">{named(name)}</text>
          <text x={centre[0]} y={centre[1] + 12}>{wrong ? "Two sides cross" : `${area(points).toFixed(1)} m²`}</text>
        </g>
      )}
      {handles && sides.map(([a, b, i]) => <Side key={`s${i}`} view={view} a={a} b={b}
        away={closed ? centre : null}
        splits={points.length < most(kind)} split={(event) => split(event, i)} />)}
      {handles && points.map((p, i) => (
        <g key={`c${i}`} class="corner" tabIndex={0} role="button"
          aria-label={`Corner ${i + 1} at ${p[0].toFixed(2)}, ${p[1].toFixed(2)} m`}
          onPointerDown={(event) => take(event, i)} onKeyDown={(event) => nudge(event, i)}
          onFocus={() => setHand(i)} onBlur={() => desk.settle()}>
          <Square at={view.to(p)} size={hand === i ? 13 : 10} full={hand === i} />
        </g>
      ))}
      {handles && hand !== null && points[hand] && (
        <Coordinates at={view.to(points[hand] as Point)} point={points[hand] as Point} />
      )}
    </g>
  );
}

function Square({ at: [x, y], size, full }: { at: Point; size: number; full: boolean }) {
  return (
    <>
      <circle class="reach" cx={x} cy={y} r="14" />
      <rect class={full ? "square full" : "square"} x={x - size / 2} y={y - size / 2} width={size} height={size} />
    </>
  );
}

function Coordinates({ at: [x, y], point }: { at: Point; point: Point }) {
  const text = `${point[0].toFixed(2)}, ${point[1].toFixed(2)} m`;
  return (
    <g class="at" aria-hidden="true">
      <rect x={x + 14} y={y - 11} width={text.length * 6.9 + 14} height="22" rx="4" />
      <text x={x + 21} y={y + 4}>{text}</text>
    </g>
  );
}

function Side(
  { view, a, b, away, splits, split }:
  { view: PlanView; a: Point; b: Point; away: Point | null; splits: boolean; split: (event: PointerEvent) => void },
) {
  const [p, q] = [view.to(a), view.to(b)];
  const long = distance(p, q);
  if (long < 30) return null;
  const [x, y] = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
  let [nx, ny] = [(q[1] - p[1]) / long, (p[0] - q[0]) / long];
  if (away && (x - away[0]) * nx + (y - away[1]) * ny < 0) [nx, ny] = [-nx, -ny];
  const text = `${distance(a, b).toFixed(2)} m`;
  const [lx, ly] = [x + nx * (16 + Math.abs(nx) * 16), y + ny * 16];
  return (
    <>
      {long > 52 && (
        <g class="length" aria-hidden="true">
          <rect x={lx - 25} y={ly - 9} width="50" height="18" rx="4" />
          <text x={lx} y={ly + 4}>{text}</text>
        </g>
      )}
      {splits && (
        <g class="middle" onPointerDown={split}>
          <circle class="reach" cx={x} cy={y} r="12" />
          <circle class="ring" cx={x} cy={y} r="4" />
        </g>
      )}
    </>
  );
}

/** Return teeth to the left of the way: the side of the drop. */
function teeth(view: PlanView, points: readonly Point[]): string {
  let text = "";
  points.slice(1).forEach((point, i) => {
    const [a, b] = [view.to(points[i] as Point), view.to(point)];
    const long = distance(a, b);
    const [ux, uy] = [(b[0] - a[0]) / long, (b[1] - a[1]) / long];
    for (let s = 4; s < long; s += 8) {
      const [x, y] = [a[0] + ux * s, a[1] + uy * s];
      text += `M${x.toFixed(1)} ${y.toFixed(1)}l${(uy * 6).toFixed(1)} ${(-ux * 6).toFixed(1)}`;
    }
  });
  return text;
}

/** Return an arrow across a line in the direction "in": from its right to its left. */
function arrow(view: PlanView, points: readonly Point[]): string {
  const [a, b] = [view.to(points[0] as Point), view.to(points[1] as Point)];
  const long = Math.max(1, distance(a, b));
  const [ux, uy] = [(b[0] - a[0]) / long, (b[1] - a[1]) / long];
  const [x, y] = [(a[0] + b[0]) / 2 + ux * 12, (a[1] + b[1]) / 2 + uy * 12];
  const [nx, ny] = [uy, -ux];
  const tip: Point = [x + nx * 26, y + ny * 26];
  return `M${x} ${y}L${tip[0]} ${tip[1]}`
    + `M${tip[0] - nx * 8 - ux * 5} ${tip[1] - ny * 8 - uy * 5}L${tip[0]} ${tip[1]}`
    + `L${tip[0] - nx * 8 + ux * 5} ${tip[1] - ny * 8 + uy * 5}`;
}

