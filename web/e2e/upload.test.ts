import { existsSync, readdirSync, readFileSync } from "node:fs";
import { resolve } from "node:path";
import { describe, expect, test } from "vitest";
import { folder, page, session, show } from "./session";
import { emptyFolder, folder as root, picture, seriousFaults } from "./setup";

/** Real slices of a pelvis, where the shared data lie beside the source. */
const dicom = resolve(new URL(".", import.meta.url).pathname, "../../../shared/data/mri/prostatex0001_dicom/6.000000-t2tsetra-76610");
const image = resolve(root, "patient/image.nii.gz");

async function begin(name: string): Promise<void> {
  await show(emptyFolder(name));
  await page.waitForSelector(".upload");
}
session(() => Promise.resolve());

describe("a subject begins with an image from the browser", () => {
  test("an empty folder asks for one; what is none is refused, and leaves nothing", async () => {
    await begin("sent_file");
    expect(await page.getAttribute("body", "data-page")).toBe("image");
    expect(await seriousFaults(page)).toEqual([]);
    await page.screenshot({ path: picture("upload_1280_light") });
    await page.setInputFiles("[data-testid=choose-file]", { name: "no.nii.gz", mimeType: "", buffer: Buffer.from("no image") });
    await expect.poll(() => page.innerText(".upload p.bad")).not.toBe("");
    expect(readdirSync(folder).filter((name) => !name.startsWith("."))).toEqual([]);
  });
  test("a chosen NIfTI shows its slices, and the subject file names side and movement", async () => {
    await page.getByLabel("Side of the hip").selectOption("right");
    await page.getByLabel("Movement to simulate").selectOption("gait");
    await page.setInputFiles("[data-testid=choose-file]", image);
    await page.waitForSelector("#slices canvas");
    expect(readFileSync(resolve(folder, "subject.toml"), "utf8")).toContain('pattern = "gait"');
    expect(readFileSync(resolve(folder, "image.nii.gz")).equals(readFileSync(image))).toBe(true);
    expect(existsSync(resolve(folder, ".upload.partial", "x"))).toBe(false);
    await expect.poll(() => page.innerText("#side")).toContain("Run the whole chain");
    await page.close();
  });
  test("a dropped file does the same", async () => {
    await begin("dropped_file");
    const data = await page.evaluateHandle((bytes) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], "t1.nii.gz"));
      return transfer;
    }, readFileSync(image).toString("base64"));
    await page.dispatchEvent("#main", "drop", { dataTransfer: data });
    await page.waitForSelector("#slices canvas");
    expect(existsSync(resolve(folder, "image.nii.gz"))).toBe(true);
    await page.close();
  });
  test.skipIf(!existsSync(dicom))("a DICOM folder is sent slice by slice", async () => {
    await begin("sent_dicom");
    await page.setInputFiles("[data-testid=choose-folder]", dicom);
    await page.waitForSelector("#slices canvas", { timeout: 60_000 });
    expect(readdirSync(resolve(folder, "dicom")).length).toBe(readdirSync(dicom).length);
    await page.waitForTimeout(500);
    await page.screenshot({ path: picture("dicom_1280_light") });
    await page.close();
  });
});
