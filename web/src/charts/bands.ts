import { column, type NormalCurve, type Table } from "../core/case";

/** What lies behind a curve: lowest and highest of what is normal or likely, NaN where nothing is known. */
export interface Band {
  x: number[];
  low: number[];
  high: number[];
}
export type BandKind = "none" | "intervals" | string; // else the movement of a normal curve

/** A normal curve laid over the movement's own time; the movement is taken for one whole cycle. */
export function normalBand(curve: NormalCurve, time: number[]): Band {
  const first = time[0] ?? 0;
  const span = (time.at(-1) ?? 0) - first;
  return { x: curve.percent.map((percent) => first + (percent / 100) * span), low: curve.low, high: curve.high };
}

/** The subject's own 95 % intervals about an angle, where the movement was recorded with markers. */
export function intervalBand(motion: Table | undefined, angle: string): Band | null {
  const name = angle.replace("_deg", "_interval_deg");
  if (!motion?.columns.includes(name)) return null;
  const middle = column(motion, angle);
  const half = column(motion, name);
  return { x: column(motion, "time_s"), low: middle.map((m, i) => m - (half[i] ?? NaN)), high: middle.map((m, i) => m + (half[i] ?? NaN)) };
}

/** The bands that can be shown for a movement, the fitting one first. */
export function bandChoices(movement: string | undefined, curves: NormalCurve[], motion: Table | undefined): [value: BandKind, text: string][] {
  const normal = [...new Set(curves.map((c) => c.movement))];
  const choices: [BandKind, string][] = [["none", "none"], ...normal.map((m): [BandKind, string] => [m, `normal ${m}, mean ± SD`])];
  if (intervalBand(motion, "flexion_deg")) choices.push(["intervals", "the subject's own 95 % intervals"]);
  const fitting = normal.find((m) => m === movement) ?? (movement ? "none" : "intervals");
  return [...choices.filter(([value]) => value === fitting), ...choices.filter(([value]) => value !== fitting)];
}

export type Column = (number | null | undefined)[];

/**
 * Curves at their own places, and bands at theirs, on one axis.
 * @returns places, then each curve, then low and high of each band; undefined between a line's own places, null for a gap
 */
export function aligned(x: number[], curves: number[][], bands: Band[]): [number[], ...Column[]] {
  const places = [...new Set([...x, ...bands.flatMap((band) => band.x)])].sort((a, b) => a - b);
  const at = (own: number[], values: number[]): Column => {
    const known = new Map(own.map((place, i) => [place, values[i] ?? NaN]));
    return places.map((place) => {
      const value = known.get(place);
      return value !== undefined && Number.isNaN(value) ? null : value;
    });
  };
  return [places, ...curves.map((values) => at(x, values)), ...bands.flatMap((band) => [at(band.x, band.low), at(band.x, band.high)])];
}

export function nearestIndex(values: number[], to: number): number {
  return values.reduce((best, value, i) => (Math.abs(value - to) < Math.abs((values[best] ?? Infinity) - to) ? i : best), 0);
}
