import { existsSync, readFileSync } from "node:fs";
import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import { browser, faults, folder, page, server, session, show } from "./session";
import { beginSubject, open, picture, seriousFaults } from "./setup";

session(() => show(beginSubject("begun", true)));

interface Markup {
  markups: { controlPoints: { label: string; position: number[] }[] }[];
}
function stored(): Map<string, number[]> {
  const file = JSON.parse(readFileSync(resolve(folder, "landmarks.mrk.json"), "utf8")) as Markup;
  return new Map(file.markups[0]!.controlPoints.map((p) => [p.label, p.position]));
}
const focus = async (): Promise<number[]> => ((await page.getAttribute("#slices", "data-focus")) ?? "").split(" ").map(Number);
const slice = (n: number) => page.locator("#slices canvas").nth(n);

describe("from an MRI", () => {
  test("a folder that is just begun opens with its slices", async () => {
    await page.waitForSelector("#slices canvas");
    expect(await page.getAttribute("body", "data-page")).toBe("image");
    expect(await page.locator("#slices canvas").count()).toBe(3);
    await expect.poll(async () => (await focus()).length).toBe(3);
  });
  test("slices are linked: a click moves the cross-hair of all, wheel and keys change slices", async () => {
    await slice(0).click({ position: { x: 80, y: 80 } });
    const before = await focus();
    await slice(0).click({ position: { x: 60, y: 60 } });
    const clicked = await focus();
    expect(clicked[0]).not.toBeCloseTo(before[0]!, 1);
    expect(clicked[2]).toBeCloseTo(before[2]!, 1); // axial: the height stays
    await slice(0).hover();
    await page.mouse.wheel(0, -100);
    await expect.poll(async () => (await focus())[2]).toBeCloseTo(clicked[2]! + 1.5, 1);
    await slice(0).focus();
    await page.keyboard.press("PageDown");
    await expect.poll(async () => (await focus())[2]).toBeCloseTo(clicked[2]!, 1);
    await page.keyboard.press("ArrowRight");
    await expect.poll(async () => (await focus())[0]).toBeCloseTo(clicked[0]! + 1.5, 1);
  });
  test("a landmark is placed, moved, renamed, removed, each saved at once, each undone", async () => {
    await page.getByLabel("Name of the landmark").fill("my_point");
    await page.click("[data-testid=place]");
    await expect.poll(() => stored().get("my_point")?.[0]).toBeCloseTo((await focus())[0]!, 1);

    // moved by dragging it in the axial slice
    const box = (await slice(0).boundingBox())!;
    const from = [0.3 * box.width, 0.75 * box.height] as const; // away from the other landmarks
    await slice(0).click({ position: { x: from[0], y: from[1] } });
    await page.getByLabel("Name of the landmark").fill("dragged");
    await page.click("[data-testid=place]");
    await expect.poll(() => stored().has("dragged")).toBe(true);
    const placed = stored().get("dragged")!;
    await page.mouse.move(box.x + from[0], box.y + from[1]);
    await page.mouse.down();
    await page.mouse.move(box.x + from[0] + 30, box.y + from[1], { steps: 5 });
    await page.mouse.up();
    await expect.poll(() => stored().get("dragged")![0]! - placed[0]!).toBeGreaterThan(5);

    await page.click(".landmarks .name:text-is('dragged')");
    await page.getByLabel("Name of the landmark").fill("renamed");
    await page.click("button:text-is('Rename')");
    await expect.poll(() => stored().has("renamed")).toBe(true);
    await page.getByLabel("Remove renamed").click();
    await expect.poll(() => stored().has("renamed")).toBe(false);
    for (const name of ["renamed", "dragged"]) {
      await page.keyboard.press("Control+z");
      await expect.poll(() => stored().has(name)).toBe(true);
    }
    await page.keyboard.press("Control+z"); // the drag
    await expect.poll(() => stored().get("dragged")![0]! - placed[0]!).toBeCloseTo(0, 3);
  });
  test("a landmark is placed by the keyboard alone", async () => {
    await slice(0).focus();
    for (const key of ["ArrowUp", "ArrowUp", "PageUp"]) await page.keyboard.press(key);
    const there = await focus();
    await page.focus("#tab-image");
    for (let i = 0; i < 12 && (await page.evaluate(() => document.activeElement?.getAttribute("aria-label"))) !== "Name of the landmark"; ++i) await page.keyboard.press("Tab");
    await page.keyboard.press("Control+a");
    await page.keyboard.type("by_keys");
    await page.keyboard.press("Enter");
    await expect.poll(() => stored().get("by_keys")?.[2]).toBeCloseTo(there[2]!, 1);
    await page.keyboard.press("Control+z");
    await expect.poll(() => stored().has("by_keys")).toBe(false);
  });
  test("a second window sees the change; closing one loses nothing", async () => {
    const { page: second } = await open(browser, server.url);
    await second.waitForSelector(".landmarks li");
    await second.getByLabel("Name of the landmark").fill("from_the_second");
    await second.click("[data-testid=place]");
    await expect.poll(() => stored().has("from_the_second")).toBe(true);
    await expect.poll(() => page.locator(".landmarks .name:text-is('from_the_second')").count()).toBe(1);
    await second.close();
    // landmarks that help nobody would mislead the segmentation
    for (const name of ["from_the_second", ...(await page.locator(".landmarks .name").allInnerTexts())].filter((n, i, all) => !n.endsWith("_right") && all.indexOf(n) === i))
      await page.getByLabel(`Remove ${name}`, { exact: true }).click();
    await expect.poll(() => [...stored().keys()].every((name) => name.endsWith("_right"))).toBe(true);
  });
  test("a slice is ready in time", async () => {
    const ms = await page.evaluate(() => {
      const start = performance.now();
      for (let i = 0; i < 20; ++i) document.querySelectorAll("#slices canvas").forEach((canvas) => canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: 1 })));
      return (performance.now() - start) / 60;
    });
    expect(ms).toBeLessThan(50);
  });
  test("axe finds no serious fault", async () => {
    expect(await seriousFaults(page)).toEqual([]);
    await page.screenshot({ path: picture("image_1280_light") });
  });
  test("a run can be stopped", async () => {
    await page.click("[data-testid=segment]");
    await page.waitForSelector("section[data-state=running]");
    await page.click("#side button:has-text('Stop')");
    await page.waitForSelector("section[data-state=cancelled]", { timeout: 90_000 });
    expect(existsSync(resolve(folder, "segment"))).toBe(false);
  });
  test("the segmentation runs with progress, and its contours appear", async () => {
    await page.click("[data-testid=segment]");
    await page.waitForSelector("section[data-state=running]");
    await expect.poll(() => page.innerText("#side section p"), { timeout: 60_000 }).toMatch(/\d+ %.*so far/);
    // long before the end, the surfaces as far as they are found, in slices and 3D
    await page.waitForFunction(() => document.body.dataset["found"]?.includes("femur"), null, { timeout: 600_000 });
    expect(existsSync(resolve(folder, "segment"))).toBe(false);
    await page.waitForTimeout(500);
    await page.screenshot({ path: picture("segmenting_1280_light") });
    // the page comes back by itself with the surfaces
    await page.waitForFunction(() => document.querySelectorAll("[data-layer]").length >= 4, null, { timeout: 600_000 });
    expect(existsSync(resolve(folder, "segment/femur.vtp"))).toBe(true);
    await page.click("#tab-image");
    await page.waitForSelector("#slices canvas");
    await page.waitForTimeout(1000);
    await page.screenshot({ path: picture("segmented_1280_light") });
    expect(faults).toEqual([]);
  }, 700_000);
});
