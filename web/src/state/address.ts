// What the address of the page holds: page, view, person, event, time.

export type Page = "live" | "review" | "zones" | "system";
export const PAGES: readonly Page[] = ["live", "review", "zones", "system"];

export interface Address {
  page: Page;
  /** Overview, edge, top, follow, alarm, or camera:NAME; plan for the plan. */
  view: string;
  person: number | null;
  /** What Review or Zones shows: an event, a recording, a zone. */
  subject: string | null;
  /** A moment [s] that is replayed; null for live. */
  t: number | null;
}

export const home: Address = {
  page: "live", view: "overview", person: null, subject: null, t: null,
};

/** Read an address. What cannot be read is as on the first page. */
export function parse(path: string, search: string): Address {
  const [page = "", subject = ""] = path.split("/").filter(Boolean).map(decode);
  const query = new URLSearchParams(search);
  const number = (name: string): number | null => {
    const text = query.get(name);
    const value = text === null || text === "" ? NaN : Number(text);
    return Number.isFinite(value) ? value : null;
  };
  return {
    page: PAGES.find((known) => known === page) ?? "live",
    view: query.get("view") || "overview",
    person: number("p"),
    subject: subject || null,
    t: number("t"),
  };
}

function decode(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** Write an address: the shortest that `parse` reads as the same. */
export function write(address: Address): string {
  const query = new URLSearchParams();
  if (address.person !== null) query.set("p", String(address.person));
  if (address.view !== "overview") query.set("view", address.view);
  if (address.t !== null) query.set("t", address.t.toFixed(2));
  const subject = address.subject ? `/${encodeURIComponent(address.subject)}` : "";
  const text = query.toString();
  return `/${address.page}${subject}${text ? `?${text}` : ""}`;
}
