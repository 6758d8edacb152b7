import { readFileSync, rmSync } from "node:fs";
import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import { browser, faults, folder, page, server, serveAgain, session, show } from "./session";
import { open, picture, seriousFaults } from "./setup";

session(async (finished) => {
  await show(finished);
  await page.click("#tab-exam");
});

const verdict = "#side p[data-status]";
const status = async (): Promise<string> => (await page.getAttribute(verdict, "data-status")) ?? "";
const flexion = async (): Promise<number> => Number(/flexion (-?[\d.]+)°/.exec(await page.innerText(verdict))?.[1]);
const slide = (axis: string, value: number): Promise<void> => page.fill(`[data-axis=${axis}]`, String(value));

describe("the live examination", () => {
  test("answers the first pose with an equilibrium", async () => {
    await page.waitForSelector(verdict, { timeout: 30_000 });
    await expect.poll(status, { timeout: 30_000 }).toBe("converged");
  });
  test("follows the slider, and says what it cost", async () => {
    const start = await flexion();
    await slide("flexion_deg", Math.round(start) + 6);
    await expect.poll(flexion, { timeout: 30_000 }).toBeGreaterThan(start + 1);
    const times = JSON.parse((await page.getAttribute("#side tbody[data-times]", "data-times"))!) as Record<string, number>;
    console.log("live, ms:", JSON.stringify(times));
    expect(times["solver"]).toBeGreaterThan(0);
    expect(times["javascript"]).toBeGreaterThan(0);
    expect(await page.innerText("#side")).toMatch(/Peak pressure \(99th percentile\)\s+[\d.]+ MPa/);
  });
  test("at rest compares with the full solution", async () => {
    await page.waitForSelector("#side p[data-settled=yes]", { timeout: 40_000 });
    expect(await page.innerText("#side p[data-settled=yes]")).toMatch(/peak pressure [\d.]+ by hand, [\d.]+ MPa settled/);
    await page.screenshot({ path: picture("exam_1280_light") });
  });
  test("is led by the mouse", async () => {
    const before = Number(await page.inputValue("[data-axis=flexion_deg]"));
    await page.click("text=Mouse leads the leg");
    const box = (await page.locator("#scene").boundingBox())!;
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 - 16, { steps: 4 });
    await page.mouse.up();
    expect(Number(await page.inputValue("[data-axis=flexion_deg]"))).toBeCloseTo(before + 4, 0);
    await page.click("text=Mouse leads the leg");
  });
  test("is led by the keyboard, recorded, saved as a movement and replayed", async () => {
    rmSync(resolve(folder, "movements"), { recursive: true, force: true });
    await page.click("button:text-is('Record')");
    await page.focus("[data-axis=flexion_deg]");
    for (let i = 0; i < 4; ++i) {
      const count = Number(/(\d+) poses/.exec((await page.locator("#panel p.note", { hasText: "poses" }).innerText()))?.[1]);
      await page.keyboard.press("ArrowRight");
      await expect.poll(async () => Number(/(\d+) poses/.exec(await page.locator("#panel p.note", { hasText: "poses" }).innerText())?.[1]), { timeout: 20_000 }).toBeGreaterThan(count);
    }
    await page.click("button:text-is('Stop')");
    await page.getByLabel("Name of the movement").fill("by_hand");
    await page.click("button:text-is('Save movement')");
    await expect.poll(() => page.innerText("#status")).toContain("movements/by_hand.toml");
    const text = readFileSync(resolve(folder, "movements/by_hand.toml"), "utf8");
    expect(text).toContain("flexion_deg");
    // from elsewhere, the leg comes back to where the record ends
    const end = Number(/flexion_deg = \[[^\]]*?(-?[\d.]+)\s*\]/.exec(text)?.[1]);
    await slide("flexion_deg", Math.round(end) - 6);
    await expect.poll(flexion, { timeout: 40_000 }).toBeLessThan(end - 3);
    await page.click("button:text-is('Replay')");
    await expect.poll(async () => Math.abs((await flexion()) - end), { timeout: 60_000 }).toBeLessThan(0.1);
  });
  test("a lost connection is shown, and the examination goes on when the server is back", async () => {
    await server.stop();
    await expect.poll(() => page.innerText("#connection")).toContain("lost");
    await serveAgain();
    await expect.poll(() => page.innerText("#connection"), { timeout: 15_000 }).toBe("connected");
    const before = await flexion();
    await slide("flexion_deg", Math.round(before) + 3);
    await expect.poll(flexion, { timeout: 40_000 }).not.toBe(before);
  });
  test("axe finds no serious fault", async () => {
    expect(await seriousFaults(page)).toEqual([]);
  });
  test("fills a 4K screen in the dark", async () => {
    await page.setViewportSize({ width: 3840, height: 2160 });
    await page.click("#theme");
    await page.waitForTimeout(2500);
    expect(await page.evaluate(() => document.documentElement.scrollHeight <= window.innerHeight)).toBe(true);
    await page.screenshot({ path: picture("exam_4k_dark") });
    await page.click("#theme");
    await page.setViewportSize({ width: 1280, height: 800 });
  });
  test("two windows each lead a hip of their own", async () => {
    const { page: second } = await open(browser, server.url);
    await second.click("#tab-exam");
    await second.waitForSelector(verdict, { timeout: 30_000 });
    const mine = await flexion();
    await second.fill("[data-axis=adduction_deg]", "-10");
    await second.waitForTimeout(500);
    expect(await flexion()).toBe(mine);
    await second.close();
    // the lost connection was complained of by the browser itself; nothing else was
    expect(faults.filter((fault) => !fault.includes("WebSocket"))).toEqual([]);
  });
});
