import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import type { Case } from "../src/core/case";
import { writeRing } from "./ring";
import { faults, page, server, session, show } from "./session";
import { copyCase, folder as root, picture, runCoxa } from "./setup";

// a ring about the socket, clear of the femur at rest, which deep flexion lays against it
session(async (finished) => {
  await show(finished);
  const { clock } = (await (await fetch(`${server.url}api/case`)).json()) as Case;
  const folder = copyCase("labrum", []);
  writeRing(resolve(folder, "segment/acetabular_labrum.vtp"), clock!, { radius: 33, tube: 2, out: 0 });
  await runCoxa("run", resolve(root, "patient/subject.toml"), "--out", folder, "--resume");
  await show(folder);
});

const verdict = "#side p[data-status]";
const flexion = async (): Promise<number> => Number(/flexion (-?[\d.]+)°/.exec(await page.innerText(verdict))?.[1]);
const hit = async (): Promise<string> => (await page.getAttribute("#scene", "data-hit")) ?? "";

/** Led to rest, where nothing is hit. */
async function rest(): Promise<void> {
  await page.click("text=Rest");
  await expect.poll(flexion, { timeout: 120_000 }).toBeLessThan(1);
  await expect.poll(hit).toBe("");
}

describe("a hip with a labrum", () => {
  test("the result draws it, tells where the femur first touches it, and shows the place", async () => {
    expect(await page.locator("[data-layer=acetabular_labrum]").count()).toBe(1);
    expect(await page.innerText("[data-contact=labrum]")).toMatch(/The femur first touches the labrum at flexion [\d.]+°.*, at \d+:\d\d o'clock\./);
    expect(await hit()).toBe("");
    await page.click("[aria-label='Show the contact with the labrum']");
    await expect.poll(hit).toMatch(/^-?[\d.]+ -?[\d.]+ -?[\d.]+$/);
    expect(await page.getAttribute("#time", "data-frame")).not.toBe("0");
    expect(await page.innerText(".curves")).toContain("from the labrum");
    await page.screenshot({ path: picture("labrum_result_1280_light") });
  });
  test("the live examination tells its distance, and shows where the femur presses on it", async () => {
    await page.click("#tab-exam");
    await page.waitForSelector(verdict, { timeout: 30_000 });
    await rest();
    await page.click("text=Flexion 90");
    await expect.poll(() => page.innerText(verdict), { timeout: 120_000 }).toMatch(/mm into the labrum at \d+:\d\d o'clock/);
    await expect.poll(hit).not.toBe("");
    expect(await flexion()).toBeGreaterThan(5);
    await expect.poll(() => page.innerText("#side"), { timeout: 10_000 }).toMatch(/Femur to labrum\s+overlap of [\d.]+ mm at \d+:\d\d/);
    await page.screenshot({ path: picture("labrum_exam_1280_light") });
    expect(faults).toEqual([]);
  });
  test("back at rest nothing is hit, and the mark is gone", rest);
});
