import { expect, test } from "vitest";
import { duration } from "../src/app/job_panel";
import { column, textColumn } from "../src/core/case";
import { toCsv } from "../src/core/csv";

const table = { columns: ["frame", "status", "peak"], rows: [[0, "converged", 1.5], [1, "failed, \"badly\"", null]] };

test("columns are numbers where they are, NaN elsewhere", () => {
  expect(column(table, "peak")).toEqual([1.5, NaN]);
  expect(column(table, "nothing")).toEqual([NaN, NaN]);
  expect(textColumn(table, "status")[0]).toBe("converged");
});
test("CSV quotes what must be quoted and leaves empty cells empty", () => {
  expect(toCsv(table)).toBe('frame,status,peak\n0,converged,1.5\n1,"failed, ""badly""",\n');
});
test("durations are for people", () => {
  expect([5.2, 80].map(duration)).toEqual(["5 s", "1 min 20 s"]);
});
