import { existsSync, readdirSync, statSync } from "node:fs";
import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import { folder, page, server, serveAgain, session, show } from "./session";
import { copyCase, picture } from "./setup";

session(() => show(copyCase("killed", ["joint", "report"])));

describe("a server that is killed in the middle of a run", () => {
  test("leaves the finished stages and nothing half done", async () => {
    await page.click("#tab-image");
    await page.click("text=Run the whole chain");
    await expect.poll(() => page.innerText("#side section p"), { timeout: 100_000 }).toMatch(/run: joint/);
    await server.kill();
    await expect.poll(() => page.innerText("#connection")).toContain("lost");
    await page.screenshot({ path: picture("lost_1280_light") });
    expect(existsSync(resolve(folder, "joint"))).toBe(false);
    expect(existsSync(resolve(folder, "mesh/mesh.json"))).toBe(true);
  });
  test("goes on when it is started again, keeping what was finished", async () => {
    const meshed = statSync(resolve(folder, "mesh/mesh.json")).mtimeMs;
    await serveAgain();
    await expect.poll(() => page.innerText("#connection"), { timeout: 20_000 }).toBe("connected");
    await page.click("text=Run the whole chain");
    await expect.poll(() => existsSync(resolve(folder, "report/report.html")), { timeout: 200_000 }).toBe(true);
    expect(statSync(resolve(folder, "mesh/mesh.json")).mtimeMs).toBe(meshed);
    expect(readdirSync(folder).filter((name) => name.endsWith(".partial"))).toEqual([]);
    await page.waitForFunction(() => document.body.dataset["allFrames"] === "yes", null, { timeout: 60_000 });
  }, 300_000);
});
