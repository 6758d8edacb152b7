/** A WebSocket that comes back after it is lost. */

export type SocketState = "open" | "lost";

export interface SocketHandlers {
  state(state: SocketState): void;
  text(message: Record<string, unknown>): void;
  binary(message: ArrayBuffer): void;
}

/** Milliseconds before attempt n: doubling from a quarter of a second to five. */
export function retryDelay(attempt: number): number {
  return Math.min(5000, 250 * 2 ** attempt);
}

export class Socket {
  private socket: WebSocket | null = null;
  private attempt = 0;

  constructor(
    private readonly url: string,
    private readonly handlers: SocketHandlers,
  ) {
    this.open();
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** False where the connection is lost: the message is not kept. */
  send(message: Record<string, unknown>): boolean {
    if (!this.isOpen) return false;
    this.socket?.send(JSON.stringify(message));
    return true;
  }

  private open(): void {
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.attempt = 0;
      this.handlers.state("open");
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (typeof event.data === "string") this.handlers.text(JSON.parse(event.data) as Record<string, unknown>);
      else this.handlers.binary(event.data);
    };
    socket.onclose = () => {
      this.handlers.state("lost");
      setTimeout(() => this.open(), retryDelay(this.attempt++));
    };
    this.socket = socket;
  }
}
