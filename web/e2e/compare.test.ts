import { describe, expect, test } from "vitest";
import { browser, faults, page, server, session, show } from "./session";
import { open, picture, prepareOther, seriousFaults } from "./setup";

session(async (finished) => {
  await show(finished, ["--compare", await prepareOther()]);
  await page.click("#tab-compare");
  await page.waitForFunction(() => document.body.dataset["bothLoaded"] === "yes", null, { timeout: 60_000 });
});

const frames = async (): Promise<string> => (await page.getAttribute("#time", "data-frame")) ?? "";
const shot = (id: string): Promise<Buffer> => page.locator(id).screenshot();

describe("two results side by side", () => {
  test("share one slider, by share of the movement", async () => {
    await page.fill("#time input[type=range]", "3");
    await expect.poll(frames).toBe("3 2"); // four frames and three
    await page.fill("#time input[type=range]", "0");
    await expect.poll(frames).toBe("0 0");
    expect(await page.innerText("#time output")).toBe("0 % of the movement");
  });
  test("have one colour range: the greater force shows in the same colours", async () => {
    const ticks = async (): Promise<string[]> => page.locator(".colour-bar .ticks span").allInnerTexts();
    const both = Number((await ticks()).at(-1));
    await page.click("#tab-result");
    await page.click("#tab-compare");
    expect(Number((await ticks()).at(-1))).toBe(both);
    expect(both).toBeGreaterThan(5);
    const [a, b] = (await page.locator("#side tr", { hasText: "contact area" }).locator("td").allInnerTexts()).map(Number);
    expect(b!).toBeGreaterThan(1.2 * a!); // twice the force
  });
  test("look the same way: turning one turns the other", async () => {
    await page.click("#views button:has-text('front')");
    await page.waitForTimeout(500);
    const before = [await shot("#scene"), await shot("#scene2")];
    await page.focus("#scene");
    await page.keyboard.press("ArrowRight");
    await page.waitForTimeout(500);
    const led = [await shot("#scene"), await shot("#scene2")];
    expect(led[0]!.equals(before[0]!)).toBe(false);
    expect(led[1]!.equals(before[1]!)).toBe(false);
    await page.focus("#scene2");
    await page.keyboard.press("ArrowLeft");
    await page.waitForTimeout(500);
    expect((await shot("#scene")).equals(led[0]!)).toBe(false);
  });
  test("are cut and faded alike", async () => {
    await page.waitForTimeout(300);
    const before = await shot("#scene2");
    await page.fill("[data-layer=hip_bone]", "0");
    await page.waitForTimeout(500);
    expect((await shot("#scene2")).equals(before)).toBe(false);
    await page.click("#views button:has-text('into the socket')");
    await page.waitForTimeout(600);
    await page.screenshot({ path: picture("compare_1280_light") });
    await page.fill("[data-layer=hip_bone]", "30");
  });
  test("give their curves as CSV and both views as one picture", async () => {
    const panel = page.getByLabel("Take away").last();
    const [csv] = await Promise.all([page.waitForEvent("download"), panel.getByText("CSV of the curves").click()]);
    expect(csv.suggestedFilename()).toContain("compared.csv");
    const [png] = await Promise.all([page.waitForEvent("download"), panel.locator("[data-testid=png]").click()]);
    await png.saveAs(picture("compare_taken_away"));
  });
  test("axe finds no serious fault; the console has nothing to complain of", async () => {
    expect(await seriousFaults(page)).toEqual([]);
    expect(faults).toEqual([]);
  });
  test("fill a 4K screen in the dark", async () => {
    const { page: big } = await open(browser, server.url, { width: 3840, height: 2160, dark: true });
    await big.click("#tab-compare");
    await big.waitForFunction(() => document.body.dataset["bothLoaded"] === "yes");
    await big.waitForTimeout(2500);
    const [a, b] = [(await big.locator("#scene").boundingBox())!, (await big.locator("#scene2").boundingBox())!];
    expect(Math.abs(a.width - b.width)).toBeLessThan(10);
    expect(a.x + a.width).toBeLessThan(b.x + 10);
    await big.screenshot({ path: picture("compare_4k_dark") });
    await big.close();
  });
});
