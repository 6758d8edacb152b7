import { hourOf } from "../charts/clock";
import { readable, type Case, type Vec3 } from "../core/case";
import { button, byId, make } from "../core/dom";
import { shortNumber } from "../core/numbers";
import { kSurfaceFields } from "../core/surface_fields";
import type { HipModel } from "../scene/hip_model";
import type { Hit, Viewer } from "../scene/viewer";

/** A point held on a surface: its values now, followed over the frames. */
export class Probe {
  private hit: Hit | null = null;
  private readonly box = byId("probe");

  constructor(
    private readonly viewer: Viewer,
    private readonly hip: HipModel,
    private readonly info: Case,
  ) {
    // a click that did not turn the view
    let down: [number, number] = [0, 0];
    viewer.canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    viewer.canvas.addEventListener("pointerup", (event) => {
      if (event.button === 0 && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) this.at(event.clientX, event.clientY);
    });
    viewer.canvas.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.clear();
      if (event.key === "Enter") {
        const view = viewer.canvas.getBoundingClientRect();
        this.at(view.left + view.width / 2, view.top + view.height / 2);
      }
    });
  }

  clear(): void {
    this.hit = null;
    this.refresh();
  }

  refresh(): void {
    this.box.hidden = this.hit === null;
    if (!this.hit) return this.viewer.showMarker(null);
    const { layer, corners, weights } = this.hit;
    const positions = layer.mesh.geometry.getAttribute("position");
    const mix = (value: (corner: number) => number): number => corners.reduce((sum, corner, k) => sum + (weights[k] ?? 0) * value(corner), 0);
    const local: Vec3 = [mix((c) => positions.getX(c)), mix((c) => positions.getY(c)), mix((c) => positions.getZ(c))];
    const e = layer.mesh.matrix.elements;
    const place = [0, 1, 2].map((r) => (e[r] ?? 0) * local[0] + (e[4 + r] ?? 0) * local[1] + (e[8 + r] ?? 0) * local[2] + (e[12 + r] ?? 0)) as Vec3;
    this.viewer.showMarker(place);

    const rows: [string, string][] = [["LPS", place.map((c) => c.toFixed(1)).join("  ") + " mm"]];
    if (this.info.clock) {
      const hour = hourOf(this.info.clock, place);
      rows.push(["clock", `${(hour < 1 ? hour + 12 : hour).toFixed(1)} h`]);
    }
    const fields = [...this.info.fields, ...kSurfaceFields.map((f) => ({ ...f, label: f.short }))];
    for (const { key, label, unit } of fields) {
      const values = this.hip.values(layer.name, key);
      if (values) rows.push([label, `${shortNumber(mix((c) => values[c] ?? NaN))} ${unit}`]);
    }
    const body = make("tbody", {}, ...rows.map(([name, value]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, value))));
    this.box.replaceChildren(make("h2", {}, readable(layer.name)), make("table", {}, body), button("Close", () => this.clear()));
  }

  private at(x: number, y: number): void {
    this.hit = this.viewer.pick(x, y);
    this.refresh();
  }
}
