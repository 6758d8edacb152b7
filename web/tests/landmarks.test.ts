import { expect, test } from "vitest";
import { LandmarkList } from "../src/landmarks/landmark_list";

const names = (list: LandmarkList): string[] => list.landmarks.map((l) => l.name);

test("placing, moving, renaming and removing can each be undone and redone", () => {
  const list = new LandmarkList();
  list.place("b", [1, 2, 3]);
  list.place("a", [4, 5, 6]);
  list.place("b", [7, 8, 9]);
  list.rename("a", "c");
  list.remove("b");
  expect(names(list)).toEqual(["c"]);
  list.undo();
  list.undo();
  expect(names(list)).toEqual(["a", "b"]);
  expect(list.landmarks[1]?.position_lps_mm).toEqual([7, 8, 9]);
  list.undo();
  expect(list.landmarks[1]?.position_lps_mm).toEqual([1, 2, 3]);
  list.redo();
  list.redo();
  expect(names(list)).toEqual(["b", "c"]);
  list.place("d", [0, 0, 0]);
  expect(list.canRedo).toBe(false);
});
test("a name must be a word that is not taken", () => {
  const list = new LandmarkList();
  list.place("a", [1, 2, 3]);
  list.place("b", [1, 2, 3]);
  expect(() => list.rename("a", "b")).toThrow("already");
  expect(() => list.rename("a", "../x")).toThrow("no name");
});
test("a place that is changed afterwards outside does not change the list", () => {
  const list = new LandmarkList();
  const place: [number, number, number] = [1, 2, 3];
  list.place("a", place);
  place[0] = 99;
  expect(list.landmarks[0]?.position_lps_mm[0]).toBe(1);
});
test("what is stored replaces all and has no steps before it", () => {
  const list = new LandmarkList();
  list.place("a", [1, 2, 3]);
  list.reset([{ name: "z", position_lps_mm: [0, 0, 0] }]);
  expect(names(list)).toEqual(["z"]);
  expect(list.canUndo).toBe(false);
});
