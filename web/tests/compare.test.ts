import { describe, expect, test } from "vitest";
import { frameAt, pairOf, spread } from "../src/compare/shares";

describe("two movements side by side", () => {
  test("are looked at by share, whatever their lengths", () => {
    expect([0, 0.5, 1].map((share) => frameAt(share, 14))).toEqual([0, 7, 13]);
    expect([0, 0.5, 1].map((share) => frameAt(share, 3))).toEqual([0, 1, 2]);
    expect(frameAt(2, 3)).toBe(2);
    expect(frameAt(0.5, 1)).toBe(0);
  });
  test("have values between frames, none beside a frame without", () => {
    expect(spread([0, 10, 20], 5)).toEqual([0, 5, 10, 15, 20]);
    expect(spread([0, NaN, 20], 5)).toEqual([0, NaN, NaN, NaN, 20]);
    expect(spread([7], 3)).toEqual([7, 7, 7]);
    expect(spread([1, 2], 1)).toEqual([1]);
  });
  test("differ by the second less the first", () => {
    expect(pairOf("area", "mm²", 300, 280).change).toBe(-20);
  });
});
