import type { Vec3 } from "../core/case";
import { checkbox, make, range, say } from "../core/dom";
import type { Viewer } from "../scene/viewer";
import { SlicePlanes } from "../slices/slice_planes";
import { placeOf, type Orientation, type Volume } from "../slices/volume";

const kOrientations: Orientation[] = ["axial", "coronal", "sagittal"];
const kNormals: Record<Orientation, Vec3> = { sagittal: [1, 0, 0], coronal: [0, 1, 0], axial: [0, 0, 1] };
const kReach = 80; // mm to either side

/** Which slices of the MRI stand in the 3D view, and where; the clip plane takes its slice along. */
export class SliceControls {
  readonly element = make("section", { "aria-label": "Slices in the 3D view" });
  private planes: SlicePlanes | null = null;
  private centre: Vec3;
  private readonly state = new Map(kOrientations.map((o) => [o, { on: false, offset: 0, slider: null as HTMLInputElement | null, shown: make("output", {}, "0 mm") }]));
  private window: [number, number] | null = null;

  constructor(
    private readonly viewer: Viewer,
    centre: Vec3 | null,
    private readonly volume: () => Promise<Volume>,
  ) {
    this.centre = centre ?? [0, 0, 0];
    this.element.append(make("h2", {}, "MRI slices in 3D"), ...kOrientations.flatMap((o) => this.row(o, centre === null)));
  }

  setWindow(window: [number, number]): void {
    this.window = window;
    this.planes?.setWindow(window);
  }

  /** The clip plane has moved: the slice of its orientation goes there. */
  follow(orientation: Orientation, offset: number): void {
    const state = this.state.get(orientation);
    if (state?.on) this.move(orientation, offset);
  }

  private row(orientation: Orientation, centreOfImage: boolean): HTMLElement[] {
    const state = this.state.get(orientation);
    if (!state) return [];
    const slider = range(-kReach, kReach, 0.5, 0, (offset) => this.move(orientation, offset));
    slider.setAttribute("aria-label", `${orientation} slice, mm from the joint centre`);
    slider.dataset["slice"] = orientation;
    slider.disabled = true;
    state.slider = slider;
    const box = checkbox(orientation, false, (on) => void this.toggle(orientation, on, centreOfImage));
    return [make("div", { class: "row" }, box, state.shown, slider)];
  }

  private async toggle(orientation: Orientation, on: boolean, centreOfImage: boolean): Promise<void> {
    const state = this.state.get(orientation);
    if (!state?.slider) return;
    state.on = on;
    state.slider.disabled = !on;
    try {
      if (on) await this.prepare(centreOfImage);
      this.draw(orientation);
    } catch (error) {
      say((error as Error).message, "error");
    }
  }

  private async prepare(centreOfImage: boolean): Promise<void> {
    if (this.planes) return;
    say("Reading the image …");
    const volume = await this.volume();
    if (centreOfImage) this.centre = placeOf(volume, volume.size.map((n) => (n - 1) / 2) as Vec3);
    this.planes = new SlicePlanes(this.viewer, volume);
    if (this.window) this.planes.setWindow(this.window);
    say("");
  }

  private move(orientation: Orientation, offset: number): void {
    const state = this.state.get(orientation);
    if (!state?.slider) return;
    state.offset = offset;
    state.slider.value = String(offset);
    state.shown.textContent = `${offset} mm`;
    this.draw(orientation);
  }

  private draw(orientation: Orientation): void {
    const state = this.state.get(orientation);
    if (!state) return;
    const normal = kNormals[orientation];
    const place = this.centre.map((c, i) => c + (normal[i] ?? 0) * state.offset) as Vec3;
    this.planes?.show(orientation, state.on ? place : null);
    document.body.dataset["slices3d"] = kOrientations.filter((o) => this.state.get(o)?.on).join(" ");
  }
}
