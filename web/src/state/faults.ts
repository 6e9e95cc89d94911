// Words for faults of the site itself: of its cameras, the 3D people, the storage.

import type { Alert } from "./alerts.ts";
import type { Health } from "./messages.ts";
import { duration, named, whole } from "./words.ts";

export type Part = "camera" | "fusion" | "store";

const PARTS: readonly Part[] = ["camera", "fusion", "store"];

/** Return which part of the site an event of this kind is about; null for one about people. */
export const partOf = (kind: string): Part | null =>
  PARTS.find((part) => kind === `${part}.health` || (part === "camera" && kind.startsWith("camera."))) ?? null;

/** Return why a part fails, in the server's words: what follows the name of the part. */
export function why(alert: Alert): string {
  const text = alert.fault ?? "";
  const at = text.indexOf(": ");
  return at < 0 ? "" : text.slice(at + 2);
}

/** Whether the part works again although its alert has not ended: it may fail again. */
export function isBack(alert: Alert, health: Health | null): boolean {
  if (!health || alert.end !== null) return false;
  switch (alert.part) {
    case "camera":
      return health.cameras[alert.camera ?? ""]?.state === "live";
    case "fusion":
      return health.fusion.state === "running";
    case "store":
      return health.store.state === "writing";
    default:
      return false;
  }
}

/** Return the title of a fault's card. */
export function faultTitle(alert: Alert): string {
  const over = alert.end !== null;
  switch (alert.part) {
    case "fusion":
      return over ? "Watching had stopped" : alert.back ? "Watching goes on" : "Watching has stopped";
    case "store":
      return over ? "Nothing was recorded" : alert.back ? "Recording goes on" : "Nothing is recorded";
    default:
      return `Camera ${named(alert.camera ?? "")} ${cameraVerb(alert)}`;
  }
}

function cameraVerb(alert: Alert): string {
  const over = alert.end !== null;
  if (alert.kind.includes("moved") || alert.kind.includes("pose")) return "was moved";
  if (alert.kind.includes("clock")) return over ? "had a wrong clock" : "has a wrong clock";
  if (alert.back) return "sends pictures again";
  return over ? "sent no picture" : "sends no picture";
}

const AGAIN = { camera: "Picture", fusion: "Results", store: "Recorded" };
const LASTS = {
  camera: "The alert ends when pictures have come for a while.",
  fusion: "The alert ends when results have come for a while.",
  store: "The alert ends when this has lasted for a while.",
};

/** Return what a fault means, and for how long it has lasted. */
export function faultLine(alert: Alert, now: number): string {
  const part = alert.part ?? "camera";
  const lasted = Math.max(0, (alert.end ?? now) - alert.start);
  if (alert.end !== null) return `${AGAIN[part]} ${part === "store" ? "again" : "back"} after ${duration(lasted)}.`;
  if (alert.back) return LASTS[part];
  const reason = why(alert) ? `: ${why(alert)}` : "";
  const long = Number.isFinite(alert.start) ? `for ${whole(lasted)}` : "since the start";
  switch (part) {
    case "fusion":
      return `No 3D people ${long}${reason}. No alert for people can fire.`;
    case "store":
      return `People are tracked. Storage fails ${long}${reason}.`;
    default:
      return `No picture ${long}${reason}. Its part of the site is less well covered.`;
  }
}

/** Return when a fault of this kind is an alert. */
export function faultRule(alert: Alert): string {
  switch (alert.part) {
    case "fusion":
      return "There was no new result for 3 s.";
    case "store":
      return "Tracks or events could not be written.";
    default:
      return "A camera is stale when its newest picture is older than 2 s, and down after 10 s.";
  }
}
