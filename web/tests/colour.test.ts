import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { mapColour, maps, noValue, structureColours } from "../src/colour/maps";
import { rangeOf } from "../src/colour/scale";

const source = readFileSync(new URL("../../src/view/colour_map.cpp", import.meta.url), "utf8");
const triples = (text: string): number[][] => [...text.matchAll(/\{(\d+), (\d+), (\d+)\}/g)].map((m) => [Number(m[1]), Number(m[2]), Number(m[3])]);

test.each([["viridis", "kViridis"], ["cividis", "kCividis"]] as const)("%s is the map that the pictures use", (name, constant) => {
  const from = source.indexOf(constant);
  expect(triples(source.slice(from, source.indexOf(";", from)))).toEqual(maps[name]);
});
test.each(Object.keys(structureColours))("%s has the colour that the pictures use", (name) => {
  const at = source.indexOf(`{"${name}", {`);
  expect(at).toBeGreaterThan(0);
  expect(triples(source.slice(at, at + 60).replace(`{"${name}", `, ""))[0]).toEqual(structureColours[name]);
});
test("colours are clamped at the ends, and NaN is grey", () => {
  expect(mapColour("viridis", -1)).toEqual(maps.viridis[0]);
  expect(mapColour("viridis", 2)).toEqual(maps.viridis.at(-1));
  expect(mapColour("viridis", NaN)).toEqual(noValue);
  expect(mapColour("viridis", 0.5 / 32)).toEqual([70, 7, 90]);
});
test("lightness rises along each map", () => {
  for (const table of Object.values(maps)) {
    const light = table.map(([r, g, b]) => 0.2126 * (r / 255) ** 2.2 + 0.7152 * (g / 255) ** 2.2 + 0.0722 * (b / 255) ** 2.2);
    for (let i = 1; i < light.length; ++i) expect(light[i]).toBeGreaterThan((light[i - 1] ?? 0) - 1e-4);
  }
});
test("one hot vertex does not set the range, and zeros of no contact neither", () => {
  const values = new Float32Array(4000).fill(0);
  for (let i = 0; i < 200; ++i) values[i] = 2 + i / 200;
  values[3999] = 1000;
  const [low, high] = rangeOf([values]);
  expect(low).toBe(0);
  expect(high).toBeGreaterThan(2.9);
  expect(high).toBeLessThan(3.1);
});
test("a range is never empty", () => {
  expect(rangeOf([])).toEqual([0, 1]);
  const [low, high] = rangeOf([new Float32Array([5, 5, 5])]);
  expect(high).toBeGreaterThan(low);
});
