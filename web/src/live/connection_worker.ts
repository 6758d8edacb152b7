import { decodeBundle } from "../core/bundle";
import { Socket } from "../core/socket";
import type { FromWorker, ToWorker } from "./connection";
import { LiveClient } from "./live_client";

const page = self as unknown as { postMessage(message: FromWorker, transfer?: ArrayBuffer[]): void };
let socket: Socket | null = null;
const client = new LiveClient(
  (message) => socket?.send(message) ?? false,
  (answer) => {
    const buffers = new Set([...answer.bundle.arrays.values()].map((values) => values.buffer as ArrayBuffer));
    page.postMessage({ kind: "answer", answer }, [...buffers]);
  },
);

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  switch (data.kind) {
    case "open":
      socket = new Socket(data.url, {
        state: (state) => page.postMessage({ kind: "state", state }),
        text: (message) => page.postMessage({ kind: "text", message }),
        binary: (message) => client.receive(decodeBundle(message)),
      });
      break;
    case "send":
      socket?.send(data.message);
      break;
    case "field":
      client.field = data.field;
      break;
    case "move":
      client.moveTo(data.pose);
      break;
    case "fail":
      client.fail(data.number);
      break;
    default:
      client[data.kind]();
  }
};
