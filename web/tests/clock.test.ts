import { expect, test } from "vitest";
import { flattened, hourOf, sectorMeans, sectorOf } from "../src/charts/clock";
import type { Clock } from "../src/core/case";

// a socket that opens along -z: twelve is y, three is x
const clock: Clock = { centre: [1, 2, 3], axis: [0, 0, -1], twelve: [0, 1, 0], three: [1, 0, 0] };

test("hours go round from twelve to three", () => {
  expect(hourOf(clock, [1, 7, 3])).toBeCloseTo(0);
  expect(hourOf(clock, [6, 2, 3])).toBeCloseTo(3);
  expect(hourOf(clock, [1, -3, 3])).toBeCloseTo(6);
  expect(hourOf(clock, [-4, 2, 3])).toBeCloseTo(9);
});
test("a sector reaches half an hour to both sides of its hour", () => {
  const at = (hour: number): number => sectorOf(clock, [1 + Math.sin((hour * Math.PI) / 6), 2 + Math.cos((hour * Math.PI) / 6), 3]);
  expect([at(11.6), at(0.4), at(0.6), at(2.9)]).toEqual([0, 0, 1, 3]);
});
test("the flattened socket keeps angles from its pole", () => {
  expect(flattened(clock, [1, 2, 13])[0]).toBeCloseTo(0);
  const [x, y] = flattened(clock, [1 + 10, 2, 3]); // a right angle from the pole, at three
  expect(x).toBeCloseTo(1);
  expect(y).toBeCloseTo(0);
  expect(flattened(clock, [1, 2 + 10, 3 + 10])[1]).toBeCloseTo(0.5); // 45 degrees, at twelve
});
test("means by hour leave out what has no value", () => {
  const means = sectorMeans(new Uint8Array([3, 3, 3, 4]), [0, 1, 2, 3], new Float32Array([1, 3, NaN, 5]));
  expect(means[3]).toEqual({ count: 2, mean: 2, high: 3 });
  expect(means[4]?.mean).toBe(5);
  expect(means[0]?.mean).toBeNaN();
});
