import { describe, expect, test } from "vitest";
import { aligned, bandChoices, intervalBand, nearestIndex, normalBand } from "../src/charts/bands";
import type { NormalCurve } from "../src/core/case";

const curve: NormalCurve = { movement: "gait", angle: "flexion_deg", source: "somebody 2008", percent: [0, 50, 100], low: [30, -10, 30], high: [40, 2, 40] };
const motion = { columns: ["time_s", "flexion_deg", "flexion_interval_deg"], rows: [[0, 10, 1], [1, 20, null]] };

describe("bands behind the angles", () => {
  test("lie over the movement's own time, at their own points", () => {
    expect(normalBand(curve, [2, 3, 6])).toEqual({ x: [2, 4, 6], low: curve.low, high: curve.high });
  });
  test("share their plot with curves of fewer points: what is not theirs is passed over, what lacks is a gap", () => {
    expect(aligned([0, 1, 2], [[5, NaN, 7]], [{ x: [0, 0.5, 2], low: [1, 2, 3], high: [4, NaN, 6] }])).toEqual([
      [0, 0.5, 1, 2],
      [5, undefined, null, 7],
      [1, 2, undefined, 3],
      [4, null, undefined, 6],
    ]);
    expect(nearestIndex([0, 1, 2], 1.4)).toBe(1);
  });
  test("of the subject are half-widths about the angle, where there are any", () => {
    expect(intervalBand(motion, "flexion_deg")).toEqual({ x: [0, 1], low: [9, NaN], high: [11, NaN] });
    expect(intervalBand(motion, "adduction_deg")).toBeNull();
    expect(intervalBand(undefined, "flexion_deg")).toBeNull();
  });
  test("begin with what fits: the movement's own, none for another, intervals for markers", () => {
    const first = (movement: string | undefined): string | undefined => bandChoices(movement, [curve], motion)[0]?.[0];
    expect(first("gait")).toBe("gait");
    expect(first("squat")).toBe("none");
    expect(first("")).toBe("intervals");
    expect(bandChoices("squat", [curve], undefined).map(([value]) => value)).toEqual(["none", "gait"]);
  });
});
