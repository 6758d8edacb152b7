import { expect, test } from "vitest";
import { niceTicks, percentile, shortNumber } from "../src/core/numbers";

test("short numbers have three digits", () => {
  expect([0, 1234.5, 0.012345, 1e-5, NaN].map(shortNumber)).toEqual(["0", "1230", "0.0123", "1.0e-5", "–"]);
});
test("percentiles are linear between values and pass over NaN", () => {
  expect(percentile([NaN, 3, 1, 2], 0.5)).toBe(2);
  expect(percentile([0, 10], 0.25)).toBe(2.5);
  expect(percentile([], 0.5)).toBeNaN();
});
test("ticks are round and inside the range", () => {
  expect(niceTicks(0, 8.57)).toEqual([0, 2, 4, 6, 8]);
  expect(niceTicks(-0.03, 0.04)).toEqual([-0.02, 0, 0.02, 0.04]);
});
