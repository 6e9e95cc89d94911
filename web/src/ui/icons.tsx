import { GLYPHS } from "../draw/mark.ts";
import { mark } from "../state/marks.ts";
import type { Severity } from "../state/messages.ts";

const LINES = {
  live: "M12 11.2a.8.8 0 1 0 0 1.6a.8.8 0 1 0 0-1.6zM8.5 15.5a5 5 0 0 1 0-7M15.5 8.5a5 5 0 0 1 0 7M5.6 18.4a9 9 0 0 1 0-12.8M18.4 5.6a9 9 0 0 1 0 12.8",
  review: "M4 5v4h4M4.3 9a8 8 0 1 1-.3 4.5M12 8v4.5l3 1.8",
  zones: "M8.6 5.9 15.6 5.1M17.8 6.5 19.2 11.6M18.3 14.4 13.4 17.8M10.5 18.2 6 15.6M4.9 13 6.3 7.8M7 4.7a1.6 1.6 0 1 0 0 3.2a1.6 1.6 0 1 0 0-3.2zM17.2 3.4a1.6 1.6 0 1 0 0 3.2a1.6 1.6 0 1 0 0-3.2zM19.6 11.7a1.6 1.6 0 1 0 0 3.2a1.6 1.6 0 1 0 0-3.2zM12 17.2a1.6 1.6 0 1 0 0 3.2a1.6 1.6 0 1 0 0-3.2zM4.6 13a1.6 1.6 0 1 0 0 3.2a1.6 1.6 0 1 0 0-3.2z",
  system: "M3 12h4l2.5-6.5 5 13L17 12h4",
  help: "M12 3.5a8.5 8.5 0 1 0 0 17a8.5 8.5 0 1 0 0-17zM9.6 9.5a2.5 2.5 0 1 1 3.5 2.3c-.8.4-1.1.9-1.1 1.7M12 16.6v.1",
  moon: "M20 14.2A8.2 8.2 0 0 1 9.8 4a8.2 8.2 0 1 0 10.2 10.2z",
  sun: "M12 8a4 4 0 1 0 0 8a4 4 0 1 0 0-8zM12 2.5v2M12 19.5v2M2.5 12h2M19.5 12h2M5.3 5.3l1.4 1.4M17.3 17.3l1.4 1.4M5.3 18.7l1.4-1.4M17.3 6.7l1.4-1.4",
  user: "M12 4a4 4 0 1 0 0 8a4 4 0 1 0 0-8zM5 20c.6-3.6 3.4-5.5 7-5.5s6.4 1.9 7 5.5",
  cube: "M12 3l7.8 4.5v9L12 21l-7.8-4.5v-9zM4.2 7.5 12 12l7.8-4.5M12 12v9",
  plan: "M4 5.5h16v13H4zM4 12h16M11 5.5V12M15 12v6.5",
  layers: "M12 4 3.5 8.5 12 13l8.5-4.5zM4 12.5l8 4.3 8-4.3M4 16.5l8 4 8-4",
  expand: "M8 4H4v4M16 4h4v4M8 20H4v-4M16 20h4v-4",
  filter: "M4 7h16M7 12h10M10 17h4",
  sound: "M4 10v4h3l4.5 3.5v-11L7 10zM15 9.5a3.5 3.5 0 0 1 0 5M17.5 7a7 7 0 0 1 0 10",
  mute: "M4 10v4h3l4.5 3.5v-11L7 10zM15.5 9.5l5 5M20.5 9.5l-5 5",
  camera: "M3.5 7.5h11v9h-11zM14.5 10.8 20.5 8v8l-6-2.8z",
  nocamera: "M6.5 7.5h8v7M14.5 10.8 20.5 8v8l-2-1M12.5 16.5h-9v-9M3.5 3.5l17 17",
  pause: "M8.5 6v12M15.5 6v12",
  play: "M8 5.5v13l10.5-6.5z",
  back: "M18 6v12L9 12zM6 6v12",
  forward: "M6 6v12l9-6zM18 6v12",
  follow: "M12 6.5a5.5 5.5 0 1 0 0 11a5.5 5.5 0 1 0 0-11zM12 3v6M12 15v6M3 12h6M15 12h6",
  close: "M6 6l12 12M18 6 6 18",
  more: "M6 12h.01M12 12h.01M18 12h.01",
  link: "M10 14a4 4 0 0 0 5.7 0l3-3a4 4 0 0 0-5.7-5.7l-1 1M14 10a4 4 0 0 0-5.7 0l-3 3A4 4 0 0 0 11 18.7l1-1",
  calendar: "M4.5 6h15v14h-15zM4.5 10h15M8.5 3.5V7M15.5 3.5V7",
  left: "M14.5 6 8.5 12l6 6",
  right: "M9.5 6l6 6-6 6",
  check: "M5 12.5 10 17.5 19 7",
  area: "M6 6.5h11L19.5 17.5H4.5z",
  line: "M5 19 19 5M5 19m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0M19 5m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0",
  edge: "M3 8h18M8 8l-3 5M13 8l-3 5M18 8l-3 5",
  select: "M6 4l12 7-5.4 1.3L9.8 18z",
  undo: "M8 5 4 9l4 4M4 9h9a5 5 0 0 1 0 10H9",
  redo: "M16 5l4 4-4 4M20 9h-9a5 5 0 0 0 0 10h4",
  add: "M12 5v14M5 12h14",
  pen: "M4 20l1-4L16 5l3 3L8 19zM14 7l3 3",
  trash: "M5 7h14M10 7V4.5h4V7M7 7l1 12.5h8L17 7M10.5 10.5v6M13.5 10.5v6",
  clock: "M12 3.5a8.5 8.5 0 1 0 0 17a8.5 8.5 0 1 0 0-17zM12 7.5V12l3 2",
  lost: "M3.5 9.5a12.5 12.5 0 0 1 5-2.8M12 6c3.2 0 6.2 1.3 8.5 3.5M6.5 13a8 8 0 0 1 4.5-2.2M14.5 11.3a8 8 0 0 1 3 1.7M9.5 16.4a4 4 0 0 1 5 0M12 19.5v.1M4 3.5l16 17",
  clear: "M12 3a9 9 0 1 0 0 18a9 9 0 1 0 0-18zM8 12.3l2.8 2.8L16.2 9.5",
  unarmed: "M8 12h8",
  connecting: "M12 3a9 9 0 0 1 9 9",
  brand: "M12 3.2a2 2 0 1 0 0 4a2 2 0 1 0 0-4zM6 9.2c4 1.3 8 1.3 12 0M12 10.2V15M12 15l-3.2 6M12 15l3.2 6M9.6 10v4.5M14.4 10v4.5",
} as const;

export type IconName = keyof typeof LINES;

export function Icon({ name, size = 20 }: { name: IconName; size?: number }) {
  const solid = name === "play";
  return (
    <svg
      width={size} height={size} viewBox="0 0 24 24" fill={solid ? "currentColor" : "none"}
      stroke="currentColor" stroke-width={size > 24 ? 1.5 : 1.7} stroke-linecap="round"
      stroke-linejoin="round" aria-hidden="true"
    >
      <path d={LINES[name]} />
      {name === "more" && <path d={LINES.more} stroke-width="3" />}
      {name === "unarmed" && (
        <circle cx="12" cy="12" r="9" stroke-dasharray="4.7 4.7" />
      )}
    </svg>
  );
}

/** The glyph of a severity: filled while it is open, an outline when it is closed. */
export function Glyph(
  { severity, size = 16, open = true, reversed = false }:
  { severity: Severity; size?: number; open?: boolean; reversed?: boolean },
) {
  const top = severity === "warning" ? 7 : 5;
  return (
    <svg class="glyph" width={size} height={size} viewBox="-1 -1 22 22" aria-hidden="true">
      {open ? (
        <g class={reversed ? "reversed" : severity}>
          <path class="shape" d={GLYPHS[severity]} />
          {severity === "info" ? (
            <g class="sign"><rect x="9" y="9" width="2" height="6" /><circle cx="10" cy="6.2" r="1.2" /></g>
          ) : (
            <g class="sign">
              <rect x="9" y={top} width="2" height="5.5" rx="1" />
              <circle cx="10" cy={top + 7.9} r="1.2" />
            </g>
          )}
        </g>
      ) : (
        <path class="outline" d={GLYPHS[severity]} />
      )}
    </svg>
  );
}

const MARKS = {
  disc: <circle cx="10" cy="10" r="8.5" />,
  square: <rect x="2.5" y="2.5" width="15" height="15" rx="1.5" />,
  pill: <rect x="4.8" y=".5" width="10.4" height="19" rx="5.2" />,
  plus: <path d="M6.8 1.5h6.4v5.3h5.3v6.4h-5.3v5.3H6.8v-5.3H1.5V6.8h5.3z" />,
};

/** A person's mark. */
export function MarkIcon({ slot, size = 14 }: { slot: number; size?: number }) {
  const { shape, fill } = mark(slot);
  const clip = `half-${shape}`;
  return (
    <svg class={`mark mark-${slot}`} width={size} height={size} viewBox="-1 -1 22 22" aria-hidden="true">
      {fill === "half" && (
        <clipPath id={clip}><rect x="0" y="10" width="20" height="11" /></clipPath>
      )}
      {fill === "half" && <g clip-path={`url(#${clip})`} fill="currentColor">{MARKS[shape]}</g>}
      <g
        fill={fill === "solid" ? "currentColor" : "none"} stroke="currentColor"
        stroke-width={fill === "solid" ? 0 : 3}
      >
        {MARKS[shape]}
      </g>
    </svg>
  );
}
