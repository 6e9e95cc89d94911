// What the server sends: /api/site, /api/health, /api/events and the messages of /api/stream.

export type Severity = "info" | "warning" | "alarm" | "critical";
export type PersonState = "provisional" | "confirmed" | "coasting";
export type CameraState = "live" | "stale" | "down" | "ended";
export type Number3 = [number | null, number | null, number | null];

export interface Forecast {
  t_s: number;
  xy_m: [number, number];
  cov_m2: [number, number, number];
}

export interface PersonMessage {
  person: number;
  state: PersonState;
  seen_s?: number | null;
  posture?: string | null;
  xyz_m: Number3[];
  sigma_m: (number | null)[];
  support: number[];
  velocity_mps?: [number | null, number | null, number | null] | null;
  forecast?: Forecast[] | null;
}

export interface SnapshotMessage {
  type: "snapshot";
  sent_s: number;
  t_s: number;
  people: PersonMessage[];
  volumes?: VehicleMessage[] | null;
}

/** Where a vehicle is whose position comes from a feed. */
export interface VehicleMessage {
  volume: string;
  id: string;
  xy_m: [number, number];
  heading_deg: number;
}

export interface CameraHealth {
  state: CameraState;
  fps: number;
  age_s: number | null;
  clock: "sender" | "arrival";
  dropped: number;
  dropped_by?: Record<string, number>;
  fault?: string | null;
}

export interface Health {
  status: string;
  faults?: string[];
  t_s?: number;
  cameras: Record<string, CameraHealth>;
  fusion: {
    state: "starting" | "running" | "stalled" | "ended";
    rate_hz?: number;
    step_ms?: number | null;
    age_s?: number | null;
    people?: number;
  };
  store: { state: "off" | "writing" | "failing"; fault?: string | null };
  stages?: Record<string, { median_ms: number; p95_ms: number }>;
  restarts?: Record<string, number>;
  rules?: { armed: number; total: number; mode?: string | null; fault?: string | null } | null;
  counts?: Counts | null;
}

export type Level = "A" | "B" | "C" | "D" | "E" | "F";

export interface Counts {
  since_s: number | null;
  zones: Record<string, { inside: number; density_pm2: number | null; level: Level | null }>;
  lines: Record<string, { in: number; out: number }>;
}

export interface HealthMessage extends Health {
  type: "health";
  sent_s: number;
}

export type Phase =
  | "new" | "update" | "end" | "ack" | "shelve" | "unshelve" | "close" | "reopen";
export type Reason = "true" | "false" | "test" | "expected";

export interface EventData {
  event: string;
  phase: Phase;
  seq: number;
  by?: string | null;
  until_s?: number | null;
  reason?: Reason | null;
  note?: string | null;
  severity?: Severity;
  rule?: { id: string; kind: string; config?: string };
  t_start_s?: number | null;
  t_detect_s?: number | null;
  t_end_s?: number | null;
  probability?: number | null;
  predicted?: boolean;
  lead_s?: number | null;
  people?: { person: number; floor_m?: [number, number]; speed_mps?: number; posture?: string }[];
  zone?: string;
  line?: string;
  edge?: string;
  camera?: string;
  /** Of a fault: how the part is, and what is wrong with it. */
  state?: string;
  fault?: string | null;
  direction?: string;
  count?: number;
  joints?: string[];
  threshold?: Record<string, number | string | null>;
  measures?: Record<string, number | string | null>;
  evidence?: { t_from_s?: number; t_to_s?: number; cameras?: string[] };
}

export interface CloudEvent {
  id: string;
  type: string;
  source?: string;
  subject?: string;
  time?: string;
  data: EventData;
}

export interface EventMessage {
  type: "event";
  sent_s: number;
  id?: string | number;
  event: CloudEvent;
}

export type StreamMessage = SnapshotMessage | HealthMessage | EventMessage;

export interface Me {
  user: string | null;
  role: "viewer" | "operator" | "admin" | null;
  csrf?: string | null;
}

/** What `/api/mode` tells. */
export interface Modes {
  mode: string | null;
  scheduled: string | null;
  chosen: { mode: string | null; until_s: number; by: string } | null;
  bypassed: Record<string, { until_s: number; by: string; note: string }>;
  off: string[];
  longest_s: number;
}
