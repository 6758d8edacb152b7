/**
 * Times of the application on a finished subject's folder, in chromium at 1280 × 800:
 * `COXA_BINARY=build/release/coxa npm run figures -- FOLDER` (in web/).
 */
import { readFileSync } from "node:fs";
import type { Browser, Page } from "playwright-core";
import { launch, open, serve, type Served } from "../e2e/setup";

const middle = (values: number[]): number => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)] ?? NaN;
const text = (values: number[]): string => `least ${Math.min(...values).toFixed(1)}, median ${middle(values).toFixed(1)}, longest ${Math.max(...values).toFixed(1)} (${values.length})`;

async function firstViews(server: Served, times: number): Promise<void> {
  const browser = await launch();
  const found: number[] = [];
  for (let i = 0; i < times; ++i) {
    const start = performance.now();
    const { page } = await open(browser, server.url);
    found.push(performance.now() - start);
    await page.close();
  }
  await browser.close();
  console.log(`first view, ms: ${text(found)}`);
}

async function scrub(page: Page): Promise<void> {
  await page.waitForFunction(() => document.body.dataset["allFrames"] === "yes", null, { timeout: 120_000 });
  const count = Number(await page.getAttribute("#time input[type=range]", "max")) + 1;
  const found: number[] = [];
  for (let i = 0; i < 3 * count; ++i) {
    await page.fill("#time input[type=range]", String((5 * i) % count));
    await page.waitForFunction((frame) => document.getElementById("time")?.dataset["frame"] === frame, String((5 * i) % count));
    found.push(Number(await page.getAttribute("#time", "data-ready-ms")));
  }
  console.log(`a frame ready to draw while scrubbing, ms: ${text(found)}`);
}

/** The leg is led to and fro; every answer's times. */
async function live(page: Page, seconds: number): Promise<void> {
  await page.click("#tab-exam");
  await page.waitForFunction(() => document.querySelector("#side p[data-status=converged]"), null, { timeout: 120_000 });
  // a record takes every answer, also those that the page is too busy drawing to show
  await page.click("button:text-is('Record')");
  const found = await page.evaluate(async (duration) => {
    const all: Record<string, number>[] = [];
    const times = document.querySelector("#side tbody[data-times]") as HTMLElement;
    const slider = document.querySelector("[data-axis=flexion_deg]") as HTMLInputElement;
    const watch = new MutationObserver(() => all.push(JSON.parse(times.dataset["times"] ?? "{}") as Record<string, number>));
    watch.observe(times, { attributes: true, attributeFilter: ["data-times"] });
    const start = performance.now();
    while (performance.now() - start < 1000 * duration) {
      // farther than the leg comes until it is called back: it never waits for the next pose
      slider.value = String(Math.floor((performance.now() - start) / 1500) % 2 === 0 ? 60 : 0);
      slider.dispatchEvent(new Event("input"));
      await new Promise((done) => setTimeout(done, 30));
    }
    watch.disconnect();
    return all;
  }, seconds);
  await page.click("button:text-is('Stop')");
  const arrived = Number(/(\d+) poses/.exec(await page.locator("#panel p.note", { hasText: "poses" }).innerText())?.[1]);
  console.log(`live: ${arrived} answers in ${seconds} s, ${(arrived / seconds).toFixed(1)} a second; shown ${(found.length / seconds).toFixed(1)} a second; ${found[0]?.["tets"]} tetrahedra, ${((found[0]?.["bytes"] ?? 0) / 1000).toFixed(0)} kB an answer`);
  for (const key of ["solver", "packing", "transfer", "waiting", "javascript", "drawing"]) console.log(`  ${key}, ms: ${text(found.map((times) => times[key] ?? NaN))}`);
}

/** Slices of the image scrolled through, and what the memory is then. */
async function slices(browser: Browser, page: Page, server: Served): Promise<void> {
  await page.click("#tab-image");
  await page.waitForSelector("#slices canvas", { timeout: 120_000 });
  const found = await page.evaluate(async () => {
    const all: number[] = [];
    const canvases = [...document.querySelectorAll<HTMLCanvasElement>("#slices canvas")];
    for (let i = 0; i < 40; ++i) {
      for (const canvas of canvases) canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: -1 }));
      await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
      for (const canvas of canvases) all.push(Number(canvas.parentElement?.dataset["readyMs"]));
    }
    return all;
  });
  console.log(`a slice with its contours ready to draw, ms: ${text(found)}`);
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = (await session.send("SystemInfo.getProcessInfo")) as { processInfo: { type: string; id: number }[] };
  const megabytes = (pid: number, file: string, key: string): number => Number(new RegExp(`${key}:\\s+(\\d+)`).exec(readFileSync(`/proc/${pid}/${file}`, "utf8"))?.[1]) / 1024;
  for (const { type, id } of processInfo) console.log(`  memory of chromium's ${type}: ${megabytes(id, "smaps_rollup", "Pss").toFixed(0)} MB`);
  console.log(`  memory of the server: ${megabytes(server.pid, "status", "VmRSS").toFixed(0)} MB now, ${megabytes(server.pid, "status", "VmHWM").toFixed(0)} MB at most`);
}

async function main(): Promise<void> {
  const folder = process.argv[2];
  if (!folder) throw new Error("which folder? npm run figures -- FOLDER");
  const server = await serve(folder);
  try {
    await firstViews(server, 5);
    const browser = await launch();
    const { page } = await open(browser, server.url);
    const there = (await (await fetch(`${server.url}api/case`)).json()) as { summary?: object; live: boolean; image: string | null };
    if (there.summary) await scrub(page);
    if (there.live) await live(page, 20);
    if (there.image) await slices(browser, page, server);
    await browser.close();
  } finally {
    await server.stop();
  }
}

void main();
