// The stream of the server, kept open.

import type { StreamMessage } from "../state/messages.ts";

const WAIT_S = [1, 2, 4, 8, 15] as const;
/** A socket that is open but silent for so long is given up [s]. */
const SILENT_S = 6;

/** Return how long to wait before a try [s]; the first comes after one second. */
export const backOff = (tries: number): number =>
  WAIT_S[Math.min(tries, WAIT_S.length - 1)] as number;

export interface Heard {
  opened(): void;
  message(message: StreamMessage): void;
  closed(retryInS: number): void;
  trying(): void;
}

/** Keeps the stream open: tries again after 1, 2, 4, 8, then every 15 s. */
export class Connection {
  #socket: WebSocket | null = null;
  #timer = 0;
  #silence = 0;
  #tries = 0;
  #ended = false;
  readonly #address: () => string;
  readonly #heard: Heard;

  constructor(address: () => string, heard: Heard) {
    this.#address = address;
    this.#heard = heard;
  }

  open(): void {
    this.#ended = false;
    clearTimeout(this.#timer);
    this.#socket?.close();
    const socket = new WebSocket(this.#address());
    this.#socket = socket;
    this.#heard.trying();
    socket.onopen = () => {
      this.#heard.opened();
      this.#listen(socket);
    };
    socket.onmessage = (event: MessageEvent<string>) => {
      if (this.#socket !== socket) return;
      this.#listen(socket);
      const message = read(event.data);
      if (!message) return;
      this.#tries = 0;
      this.#heard.message(message);
    };
    socket.onclose = () => {
      if (this.#socket === socket) this.#lost();
    };
  }

  close(): void {
    this.#ended = true;
    clearTimeout(this.#timer);
    clearTimeout(this.#silence);
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
  }

  #listen(socket: WebSocket): void {
    clearTimeout(this.#silence);
    this.#silence = window.setTimeout(() => {
      if (this.#socket !== socket) return;
      this.#socket = null;
      socket.close();
      this.#lost();
    }, SILENT_S * 1000);
  }

  #lost(): void {
    clearTimeout(this.#silence);
    this.#socket = null;
    if (this.#ended) return;
    const wait = backOff(this.#tries++);
    this.#heard.closed(wait);
    this.#timer = window.setTimeout(() => this.open(), wait * 1000);
  }
}

/** Return a message, or null where the text is none. */
export function read(text: unknown): StreamMessage | null {
  if (typeof text !== "string") return null;
  try {
    const message = JSON.parse(text) as StreamMessage;
    const well = typeof message?.type === "string" && typeof message.sent_s === "number";
    const people = message.type !== "snapshot" || Array.isArray(message.people);
    const event = message.type !== "event" || Boolean(message.event?.data);
    const health = message.type !== "health" || Boolean(message.cameras && message.fusion);
    return well && people && event && health ? message : null;
  } catch {
    return null;
  }
}
