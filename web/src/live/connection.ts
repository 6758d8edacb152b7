import type { SocketState } from "../core/socket";
import type { Answer, Pose } from "./live_client";

/** What the page asks of the worker that holds the connection. */
export type ToWorker =
  | { kind: "open"; url: string }
  | { kind: "send"; message: Record<string, unknown> }
  | { kind: "field"; field: string }
  | { kind: "move"; pose: Pose }
  | { kind: "again" | "leave" | "reconnect" }
  | { kind: "fail"; number: number };

export type FromWorker =
  | { kind: "state"; state: SocketState }
  | { kind: "text"; message: Record<string, unknown> }
  | { kind: "answer"; answer: Answer };

export interface ConnectionHandlers {
  state(state: SocketState): void;
  text(message: Record<string, unknown>): void;
  answer(answer: Answer): void;
}

/**
 * The connection to the server and the leading of its hip, in a worker: the next step is asked for while the page is
 * still drawing the last one, and times of transfer are not mixed with those of a busy page.
 */
export class Connection {
  private readonly worker = new Worker(new URL("./connection_worker.ts", import.meta.url), { type: "module" });
  private isOpen = false;

  constructor(url: string, handlers: ConnectionHandlers) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if (data.kind === "text") handlers.text(data.message);
      else if (data.kind === "answer") handlers.answer(data.answer);
      else {
        this.isOpen = data.state === "open";
        handlers.state(data.state);
      }
    };
    this.post({ kind: "open", url });
  }

  /** False where the connection is lost: the message is not kept. */
  send(message: Record<string, unknown>): boolean {
    if (this.isOpen) this.post({ kind: "send", message });
    return this.isOpen;
  }

  post(message: ToWorker): void {
    this.worker.postMessage(message);
  }
}
