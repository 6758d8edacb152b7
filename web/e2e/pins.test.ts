import { existsSync } from "node:fs";
import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import { decodeBundle, floats, triangles } from "../src/core/bundle";
import type { Vec3 } from "../src/core/case";
import { distanceTo } from "./distance";
import { browser, folder, page, server, session, show } from "./session";
import { beginSubject, open, picture, seriousFaults, takeSegmentation } from "./setup";

session(async () => {
  const folder = beginSubject("pinned", true);
  takeSegmentation(folder);
  await show(folder);
  await page.click("#tab-image");
  await page.waitForSelector("#slices canvas");
});

const focus = async (): Promise<number[]> => ((await page.getAttribute("#slices", "data-focus")) ?? "").split(" ").map(Number);

describe("a finished segmentation", () => {
  test("a contour is corrected by a pin: the surface passes through it, and nothing moves far away", async () => {
    const surface = async (): Promise<{ points: Float32Array; triangles: Uint32Array }> => {
      const bundle = decodeBundle(await (await fetch(`${server.url}api/surface?name=femur`)).arrayBuffer());
      return { points: floats(bundle, "positions"), triangles: triangles(bundle) };
    };
    const before = await surface();
    await page.selectOption("[data-testid=job-side]", "right");
    await page.waitForSelector(".landmarks li"); // the cross-hair stands in the femoral head then
    const first = (await focus()) as Vec3;
    // to the left of the head's centre, until the border is 0.6 to 2.5 mm away
    let steps = 1;
    const at = (n: number): Vec3 => [first[0] + 1.5 * n, first[1], first[2]];
    const off = (n: number): number => distanceTo(before.points, before.triangles, at(n));
    while (steps < 40 && !(off(steps) > 0.6 && off(steps) < 2.5)) ++steps;
    await page.locator("#slices canvas").first().focus();
    for (let i = 0; i < steps; ++i) await page.keyboard.press("ArrowRight");
    await expect.poll(async () => (await focus())[0]).toBeCloseTo(at(steps)[0], 1);
    const pin = (await focus()) as Vec3;
    await page.selectOption("[data-testid=pin-structure]", "femur");
    await page.click("[data-testid=pin]");
    const written = (): boolean => existsSync(resolve(folder, "pins.mrk.json"));
    await expect.poll(written).toBe(true);
    // each pin can be undone, and come back
    await page.click("text=Undo pin");
    await expect.poll(written).toBe(false);
    await page.click("text=Redo pin");
    await expect.poll(written).toBe(true);
    await page.screenshot({ path: picture("pinned_before_1280_light") });
    const wasOff = distanceTo(before.points, before.triangles, pin);
    const start = Date.now();
    await page.click("[data-testid=segment]");
    await page.waitForSelector("section[data-state=running]");
    await expect.poll(() => existsSync(resolve(folder, "segment/found/femur.vtp")), { timeout: 200_000 }).toBe(true);
    const after = await surface();
    console.log(`pin ${wasOff.toFixed(2)} mm off, then ${distanceTo(after.points, after.triangles, pin).toFixed(3)} mm; ${((Date.now() - start) / 1000).toFixed(0)} s`);
    expect(wasOff).toBeGreaterThan(0.5);
    expect(distanceTo(after.points, after.triangles, pin)).toBeLessThan(0.3);
    let far = 0;
    for (let i = 0; i < before.points.length; i += 3) {
      if (Math.hypot(before.points[i]! - pin[0], before.points[i + 1]! - pin[1], before.points[i + 2]! - pin[2]) < 33) continue;
      ++far;
      expect([after.points[i], after.points[i + 1], after.points[i + 2]]).toEqual([before.points[i], before.points[i + 1], before.points[i + 2]]);
    }
    expect(far).toBeGreaterThan(500);
    await page.waitForFunction(() => document.body.dataset["page"] === "result" && document.querySelectorAll("[data-layer]").length === 4, null, { timeout: 60_000 });
    await page.click("#tab-image");
    await page.waitForSelector(".landmarks .name:text-is('femur-1')");
    await page.click(".landmarks .name:text-is('femur-1')");
    await page.waitForTimeout(800);
    await page.screenshot({ path: picture("pinned_after_1280_light") });
    expect(await seriousFaults(page)).toEqual([]);
  }, 400_000);
  test("fills a 4K screen in the dark", async () => {
    const { page: big } = await open(browser, server.url, { width: 3840, height: 2160, dark: true });
    await big.click("#tab-image");
    await big.waitForSelector("#slices canvas");
    await big.waitForTimeout(2000);
    expect(await big.evaluate(() => document.documentElement.scrollHeight <= window.innerHeight)).toBe(true);
    await big.screenshot({ path: picture("image_4k_dark") });
    await big.close();
  });
});
