import { describe, expect, test } from "vitest";
import { firstContacts, firstContactText, hitOf, hourText, nearText, type NearPlace } from "../src/live/near_places";

const near = (clearance_mm: number): NearPlace => ({ clearance_mm, place: [1, 2, 3], hour: 1.5 });

describe("where the femur is near to bone or labrum", () => {
  test("hours are told as on a clock", () => {
    expect([0, 1.5, 11.99, 12, 0.25, -0.5].map(hourText)).toEqual(["12:00", "1:30", "12:00", "12:00", "12:15", "11:30"]);
  });
  test("distances, overlaps and nothing near are told apart", () => {
    expect(nearText(near(1.234))).toBe("1.23 mm at 1:30");
    expect(nearText(near(-0.4))).toBe("overlap of 0.4 mm at 1:30");
    expect(nearText(null)).toBe("more than 3 mm");
  });
  test("bone is told of before the labrum, and only what is hit", () => {
    expect(hitOf(near(-1), near(-2))?.clearance_mm).toBe(-1);
    expect(hitOf(near(1), near(-2))?.clearance_mm).toBe(-2);
    expect(hitOf(null, near(2))).toBe(null);
  });
  test("first contacts are read from the joint stage's figures", () => {
    const figures = {
      bony_limit_place_lps_mm: "104.235 29.5978 -531.222",
      bony_limit_clock_hour: 11.75,
      bony_limit_flexion_deg: 80.13,
      bony_limit_adduction_deg: -0.05,
      bony_limit_internal_rotation_deg: 35.6,
    };
    const found = firstContacts([{ verb: "joint", seconds: 1, warnings: [], figures }]);
    expect(found.map(({ what, place }) => [what, place])).toEqual([["bones", [104.235, 29.5978, -531.222]]]);
    expect(firstContactText(found[0]!)).toBe("The bones first meet at flexion 80.1°, adduction -0.1°, internal rotation 35.6°, at 11:45 o'clock.");
    expect(firstContacts([{ verb: "mesh", seconds: 1, warnings: [], figures }])).toEqual([]);
  });
});
