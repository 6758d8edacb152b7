import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Bundle } from "../src/core/bundle";
import { retryDelay } from "../src/core/socket";
import { LiveClient, type Answer, type Pose } from "../src/live/live_client";
import { Recorder } from "../src/live/recorder";
import { FrameStore } from "../src/scene/frame_store";

const pose = (flexion: number): Pose => ({ flexion_deg: flexion, adduction_deg: 0, internal_rotation_deg: 0 });
const answerTo = (number: number, meta: Record<string, unknown> = {}): Bundle => ({
  meta: { type: "step", number, status: "converged", arrived: true, reason: "", ...pose(0), ...meta },
  arrays: new Map(),
  bytes: 0,
});

let sent: Record<string, unknown>[] = [];
let answers: Answer[] = [];
let client: LiveClient;
beforeEach(() => {
  vi.useFakeTimers();
  sent = [];
  answers = [];
  client = new LiveClient((message) => sent.push(message) > 0, (answer) => answers.push(answer), () => 0);
});
afterEach(() => vi.useRealTimers());

test("one question at a time; the newest pose is asked for next", () => {
  for (const flexion of [1, 2, 3]) client.moveTo(pose(flexion));
  expect(sent.map((m) => m["flexion_deg"])).toEqual([1]);
  client.receive(answerTo(1));
  expect(sent.map((m) => m["flexion_deg"])).toEqual([1, 3]);
  expect(answers.length).toBe(1);
});
test("a way of several steps is asked for to its end, then settled after a rest", () => {
  client.moveTo(pose(10));
  client.receive(answerTo(1, { arrived: false }));
  client.receive(answerTo(2, { arrived: true }));
  expect(sent.map((m) => m["type"])).toEqual(["pose", "pose"]);
  vi.advanceTimersByTime(500);
  expect(sent.at(-1)?.["type"]).toBe("settle");
});
test("a new pose takes the place of a settling, whose answer is then passed over", () => {
  client.moveTo(pose(10));
  client.receive(answerTo(1));
  vi.advanceTimersByTime(500);
  client.moveTo(pose(11));
  expect(sent.at(-1)?.["flexion_deg"]).toBe(11);
  expect(client.receive(answerTo(2, { type: "settled" }))).toBe(false);
  expect(answers.length).toBe(1);
});
test("a leg that cannot go on is not pushed, until another pose is wanted", () => {
  client.moveTo(pose(90));
  client.receive(answerTo(1, { status: "beyond_bony_limit", arrived: true }));
  vi.advanceTimersByTime(1000);
  expect(sent.length).toBe(1);
  client.moveTo(pose(80));
  expect(sent.length).toBe(2);
});
test("after a lost connection the pose is asked for again", () => {
  client.moveTo(pose(5));
  client.reconnect();
  expect(sent.map((m) => m["flexion_deg"])).toEqual([5, 5]);
  expect(client.receive(answerTo(1))).toBe(false);
  expect(client.receive(answerTo(2))).toBe(true);
});
test("retries wait longer each time, at most five seconds", () => {
  expect([0, 1, 2, 9].map(retryDelay)).toEqual([250, 500, 1000, 5000]);
});
test("a record begins at time zero, increases, and is straight between its poses", () => {
  const recorder = new Recorder();
  recorder.add(pose(99), 1); // not recording yet
  recorder.begin();
  recorder.add(pose(0), 10);
  recorder.add(pose(5), 10); // no time has passed
  recorder.add(pose(20), 12);
  expect(recorder.movement("m")).toMatchObject({ name: "m", time_s: [0, 2], flexion_deg: [0, 20] });
  expect(recorder.at(1)?.flexion_deg).toBe(10);
  expect(recorder.at(5)?.flexion_deg).toBe(20);
});
test("frames are fetched once, and again after a failure", async () => {
  let fails = true;
  const asked: number[] = [];
  const store = new FrameStore(2, (index) => {
    asked.push(index);
    return fails ? Promise.reject(new Error("lost")) : Promise.resolve(answerTo(index));
  });
  await expect(store.get(0)).rejects.toThrow("lost");
  fails = false;
  await store.get(0);
  await store.get(0);
  expect(asked).toEqual([0, 0]);
  expect(store.peek(0)).not.toBeNull();
  await store.fetchAhead(() => undefined);
  expect(store.loaded().length).toBe(2);
});
