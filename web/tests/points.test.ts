import { describe, expect, test } from "vitest";
import { ServerError, type Landmark, type StoredLandmarks } from "../src/core/api";
import { nextPin } from "../src/landmarks/pin_panel";
import { PointStore } from "../src/landmarks/point_store";

const point = (name: string): Landmark => ({ name, position_lps_mm: [1, 2, 3] });

describe("pins", () => {
  test("are numbered by structure", () => {
    expect(nextPin("femur", [])).toBe("femur-1");
    expect(nextPin("femur", [point("femur-2"), point("hip_bone-7"), point("femur-10")])).toBe("femur-11");
    expect(nextPin("femoral_cartilage", [point("femur-2")])).toBe("femoral_cartilage-1");
  });
});

/** Stores what it is told, when it is told to answer. */
class Server {
  stored: StoredLandmarks = { version: "0", landmarks: [], known: ["a"] };
  saves = 0;
  release: (() => void)[] = [];
  busy = false;
  readonly told: string[] = [];
  readonly store = new PointStore(
    {
      what: "Pins",
      load: async () => this.stored,
      save: async (version, landmarks) => {
        this.saves += 1;
        if (this.busy) await new Promise<void>((done) => this.release.push(done));
        if (version !== this.stored.version) throw new ServerError(409, "another window was faster");
        return (this.stored = { ...this.stored, version: String(Number(version) + 1), landmarks });
      },
    },
    () => undefined,
    (text) => this.told.push(text),
  );
}
const settle = (): Promise<void> => new Promise((done) => setTimeout(done, 5));

describe("points that are saved at every change", () => {
  test("go one save at a time, the last state last", async () => {
    const server = new Server();
    await server.store.load();
    server.busy = true;
    for (const name of ["x", "y", "z"]) server.store.change((list) => list.place(name, [0, 0, 0]));
    await settle();
    expect(server.saves).toBe(1); // the others wait
    server.busy = false;
    server.release.forEach((go) => go());
    await settle();
    expect(server.saves).toBe(2);
    expect(server.stored.landmarks.map((l) => l.name)).toEqual(["x", "y", "z"]);
  });
  test("give way to another window that was faster", async () => {
    const server = new Server();
    await server.store.load();
    server.stored = { ...server.stored, version: "9", landmarks: [point("theirs")] };
    server.store.change((list) => list.place("mine", [0, 0, 0]));
    await settle();
    expect(server.told).toContain("another window was faster");
    expect(server.store.list.landmarks.map((l) => l.name)).toEqual(["theirs"]);
    await server.store.changedElsewhere("9"); // its own version: nothing to read
    expect(server.told.some((text) => text.includes("changed in another window"))).toBe(false);
    server.stored = { ...server.stored, version: "10" };
    await server.store.changedElsewhere("10");
    expect(server.told.some((text) => text.includes("changed in another window"))).toBe(true);
  });
});
