import { describe, expect, test } from "vitest";
import { chosenFrom } from "../src/app/upload_panel";

const file = (name: string, size = 10): File => ({ name, size }) as File;

describe("what is dropped", () => {
  test("is one image file, or the slices of a folder without what no reader needs", () => {
    expect(chosenFrom([file("t1.NII.GZ"), file(".DS_Store"), file("readme.txt")]).files.map((f) => f.name)).toEqual(["t1.NII.GZ"]);
    expect(chosenFrom([file("IM1"), file("IM2"), file("DICOMDIR"), file(".x"), file("empty", 0)]).files.length).toBe(2);
  });
  test("says why it cannot be sent", () => {
    expect(chosenFrom([]).fault).toContain("nothing");
    expect(chosenFrom([file("a.nii"), file("b.nii")]).fault).toContain("one image");
    expect(chosenFrom([file("a.nii", 513 * 2 ** 20)]).fault).toContain("512 MB");
  });
});
