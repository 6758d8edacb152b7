/** The colour maps of src/view/colour_map.cpp, 33 colours each, straight lines between (tests compare). */

export type Rgb = [number, number, number];
export type MapName = "viridis" | "cividis";

const viridis: Rgb[] = [
  [68, 1, 84], [71, 13, 96], [72, 24, 106], [72, 35, 116], [71, 45, 123], [69, 55, 129], [66, 64, 134],
  [62, 73, 137], [59, 82, 139], [55, 91, 141], [51, 99, 141], [47, 107, 142], [44, 114, 142], [41, 122, 142],
  [38, 130, 142], [35, 137, 142], [33, 145, 140], [31, 152, 139], [31, 160, 136], [34, 167, 133], [40, 174, 128],
  [50, 182, 122], [63, 188, 115], [78, 195, 107], [94, 201, 98], [112, 207, 87], [132, 212, 75], [152, 216, 62],
  [173, 220, 48], [194, 223, 35], [216, 226, 25], [236, 229, 27], [253, 231, 37],
];
const cividis: Rgb[] = [
  [0, 34, 78], [0, 40, 91], [0, 46, 106], [5, 51, 113], [26, 56, 111], [39, 62, 110], [50, 67, 109], [59, 73, 108],
  [67, 78, 108], [75, 84, 108], [83, 90, 109], [90, 95, 110], [97, 101, 111], [104, 106, 113], [111, 112, 115],
  [118, 118, 118], [125, 124, 120], [132, 130, 121], [140, 136, 120], [147, 142, 120], [155, 148, 118],
  [163, 154, 116], [171, 160, 114], [180, 167, 111], [188, 174, 108], [196, 180, 104], [205, 187, 99],
  [213, 194, 94], [222, 201, 88], [231, 209, 80], [240, 216, 70], [249, 224, 58], [254, 232, 56],
];
export const maps: Record<MapName, Rgb[]> = { viridis, cividis };
export const noValue: Rgb = [200, 200, 200];

export const structureColours: Record<string, Rgb> = {
  femur: [230, 159, 0],
  hip_bone: [86, 180, 233],
  femoral_cartilage: [213, 94, 0],
  acetabular_cartilage: [0, 158, 115],
  acetabular_labrum: [204, 121, 167],
};

/** Colour at a share in [0, 1], clamped; grey for NaN. */
export function mapColour(map: MapName, share: number): Rgb {
  if (Number.isNaN(share)) return noValue;
  const table = maps[map];
  const at = Math.min(1, Math.max(0, share)) * (table.length - 1);
  const i = Math.min(table.length - 2, Math.floor(at));
  const a = table[i] ?? noValue;
  const b = table[i + 1] ?? noValue;
  return [0, 1, 2].map((c) => Math.round((a[c] ?? 0) + (at - i) * ((b[c] ?? 0) - (a[c] ?? 0)))) as Rgb;
}

export const css = (colour: Rgb): string => `rgb(${colour[0]} ${colour[1]} ${colour[2]})`;
