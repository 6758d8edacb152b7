/** What the server says about the subject's folder. */

export type Vec3 = [number, number, number];

export interface Field {
  key: string;
  label: string;
  unit: string;
}

export type Cell = number | string | null;
export interface Table {
  columns: string[];
  rows: Cell[][];
}

export interface Clock {
  centre: Vec3;
  axis: Vec3;
  twelve: Vec3;
  three: Vec3;
}

export interface Stage {
  verb: string;
  seconds: number;
  warnings: string[];
  figures: Record<string, unknown>;
}

/** A band of normal values about a joint angle, by percent of the movement. */
export interface NormalCurve {
  movement: string;
  angle: string;
  source: string;
  percent: number[];
  low: number[];
  high: number[];
}

export interface Case {
  name: string;
  folder: string;
  side?: "left" | "right";
  coxa_version: string;
  fields: Field[];
  surfaces: string[];
  bodies: string[];
  image: string | null;
  image_fault: string;
  can_run: boolean;
  live: boolean;
  clock?: Clock;
  image_pose?: { flexion_deg: number; adduction_deg: number; internal_rotation_deg: number };
  summary?: Table;
  motion?: Table;
  stages?: Stage[];
  report?: string;
  movement?: string; // the pattern's name; empty for recorded markers
  movements: string[];
  normal_curves: NormalCurve[];
  other?: string; // a second result to compare with
}

/** A column of a table as numbers; NaN where a cell holds none. */
export function column(table: Table, name: string): number[] {
  const at = table.columns.indexOf(name);
  return table.rows.map((row) => (typeof row[at] === "number" ? (row[at] as number) : NaN));
}

export function textColumn(table: Table, name: string): string[] {
  const at = table.columns.indexOf(name);
  return table.rows.map((row) => String(row[at] ?? ""));
}

/** "femoral_cartilage" for people. */
export function readable(name: string): string {
  return name.replaceAll("_", " ");
}
