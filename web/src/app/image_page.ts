import { api, type Landmark } from "../core/api";
import { floats, triangles } from "../core/bundle";
import type { Case, Vec3 } from "../core/case";
import { button, byId, labelled, make, range, say } from "../core/dom";
import { PinPanel } from "../landmarks/pin_panel";
import { PointStore } from "../landmarks/point_store";
import { SliceView, type SliceState } from "../slices/slice_view";
import { indexOf, placeOf, type Orientation, type Volume } from "../slices/volume";
import type { HipModel } from "../scene/hip_model";
import type { Viewer } from "../scene/viewer";
import { JobPanel } from "./job_panel";
import { UploadPanel } from "./upload_panel";

/** Slices of the MRI with landmarks and contours, and the runs that start from them. */
export class ImagePage {
  readonly panel = make("div");
  readonly side = make("div");
  readonly jobs: JobPanel;
  state: SliceState | null = null;
  views: SliceView[] = [];
  readonly landmarks: PointStore;
  readonly pins: PinPanel;
  /** The window (level and width) is another. */
  onWindow: ((window: [number, number]) => void) | null = null;
  private readonly entries = make("ul", { class: "landmarks" });
  private readonly undoButton = button("Undo", () => this.step("undo"));
  private readonly redoButton = button("Redo", () => this.step("redo"));
  private readonly nameInput = make("input", { type: "text", list: "known-landmarks", "aria-label": "Name of the landmark", size: 20 });
  private readonly windowInputs = { level: range(0, 1, 1, 0, () => this.typeWindow()), width: range(1, 2, 1, 1, () => this.typeWindow()) };
  private opened = false;

  constructor(
    private readonly info: Case,
    private readonly viewer: Viewer,
    private readonly hip: HipModel,
    private readonly volume: () => Promise<Volume>,
    send: (message: Record<string, unknown>) => boolean,
  ) {
    this.landmarks = new PointStore({ what: "Landmarks", load: () => api.landmarks(), save: (version, points) => api.saveLandmarks(version, points) }, () => this.showList());
    this.pins = new PinPanel(() => this.state?.focus ?? [0, 0, 0], () => this.showPins(), (place) => this.moveFocus(place));
    this.jobs = new JobPanel(info, send);
    if (info.image) this.side.append(this.jobs.element);
    document.addEventListener("keydown", (event) => {
      if (document.body.dataset["page"] !== "image" || !(event.ctrlKey || event.metaKey)) return;
      if (event.key === "z") this.step("undo");
      if (event.key === "y") this.step("redo");
    });
  }

  /** The image is read when first looked at. */
  async open(): Promise<void> {
    if (this.opened) return;
    this.opened = true;
    if (!this.info.image) {
      this.panel.append(make("p", { class: "note" }, `No image: ${this.info.image_fault}`));
      byId("slices").replaceChildren(new UploadPanel(this.info.movements, byId("main"), () => location.reload()).element);
      return;
    }
    say("Reading the image …");
    try {
      const volume = await this.volume();
      const focus = placeOf(volume, volume.size.map((n) => (n - 1) / 2) as Vec3);
      this.state = { volume, focus, window: [...volume.window], landmarks: [], pins: [], selected: null, outlines: [] };
      this.buildViews(this.state);
      this.buildPanel(this.state);
      await Promise.all([this.landmarks.load(), this.pins.store.load()]);
      this.suggestName();
      this.updateOutlines();
      const head = this.list.landmarks.find((l) => l.name.startsWith("femoral_head_centre")) ?? this.list.landmarks[0];
      if (head) this.moveFocus(head.position_lps_mm);
      say("");
    } catch (error) {
      say((error as Error).message, "error");
    }
  }

  /** Surfaces that were read anew. */
  updateOutlines(): void {
    const state = this.state;
    if (!state) return;
    const sources = [...this.hip.surfaces, ...[...this.hip.bodies].map(([name, bundle]) => [`${name}_cartilage`, bundle] as const)];
    state.outlines = sources.map(([name, bundle]) => {
      const places = floats(bundle, "positions");
      const points = new Float32Array(places.length);
      for (let i = 0; i < places.length; i += 3) points.set(indexOf(state.volume, [places[i] ?? 0, places[i + 1] ?? 0, places[i + 2] ?? 0]), i);
      return { name, points, triangles: triangles(bundle) };
    });
    this.redraw();
  }

  private get list(): PointStore["list"] {
    return this.landmarks.list;
  }

  private buildViews(state: SliceState): void {
    const events = {
      moveFocus: (place: Vec3) => this.moveFocus(place),
      changeWindow: (window: [number, number]) => this.changeWindow(window),
      selectLandmark: (name: string) => this.select(name),
      moveLandmark: (name: string, place: Vec3, done: boolean) => this.drag(name, place, done),
    };
    const orientations: Orientation[] = ["axial", "sagittal", "coronal"];
    this.views = orientations.map((orientation) => new SliceView(orientation, state, events));
    byId("slices").replaceChildren(...this.views.map((view) => view.element));
  }

  private buildPanel(state: SliceState): void {
    const [low, high] = state.volume.window;
    const span = high - low;
    const { level, width } = this.windowInputs;
    Object.assign(level, { min: String(low - span / 2), max: String(high + span / 2), step: String(span / 200) });
    Object.assign(width, { min: String(span / 50), max: String(2 * span), step: String(span / 200) });
    this.changeWindow(state.window);
    const place = button("Place at cross-hair", () => this.place(), { "data-testid": "place" });
    const rename = button("Rename", () => this.rename());
    this.nameInput.addEventListener("keydown", (event) => event.key === "Enter" && this.place());
    this.panel.append(
      make("h2", {}, "Window"),
      labelled("Level", level),
      labelled("Width", width),
      make("h2", {}, "Landmarks"),
      make("datalist", { id: "known-landmarks" }),
      this.nameInput,
      make("div", { class: "buttons" }, place, rename, this.undoButton, this.redoButton),
      this.entries,
      this.pins.element,
      make("p", { class: "note" }, "Click a slice to move the cross-hair, drag a landmark or pin to move it, wheel for slices, right drag for the window. Every change is saved at once."),
    );
  }

  private redraw(): void {
    for (const view of this.views) view.invalidate();
  }

  private moveFocus(place: Vec3): void {
    if (!this.state) return;
    this.state.focus = place;
    byId("slices").dataset["focus"] = place.map((c) => c.toFixed(2)).join(" ");
    this.viewer.showMarker(place);
    this.redraw();
  }

  private changeWindow(window: [number, number]): void {
    if (!this.state) return;
    this.state.window = window;
    this.windowInputs.level.value = String((window[0] + window[1]) / 2);
    this.windowInputs.width.value = String(window[1] - window[0]);
    this.onWindow?.(window);
    this.redraw();
  }
  private typeWindow(): void {
    const level = this.windowInputs.level.valueAsNumber;
    const width = this.windowInputs.width.valueAsNumber;
    if (!this.state) return;
    this.state.window = [level - width / 2, level + width / 2];
    this.onWindow?.(this.state.window);
    this.redraw();
  }

  private select(name: string): void {
    if (!this.state) return;
    this.state.selected = name;
    this.nameInput.value = name;
    this.showList();
    const place = this.list.landmarks.find((l) => l.name === name)?.position_lps_mm;
    if (place) this.moveFocus(place);
  }

  private drag(name: string, place: Vec3, done: boolean): void {
    if (!this.state) return;
    const moved = (points: readonly Landmark[]): Landmark[] => points.map((l) => (l.name === name ? { ...l, position_lps_mm: place } : l));
    const isPin = this.pins.pins.some((pin) => pin.name === name);
    if (done) return (isPin ? this.pins.store : this.landmarks).change((list) => list.place(name, place));
    if (isPin) this.state.pins = moved(this.pins.pins);
    else this.state.landmarks = moved(this.list.landmarks);
    this.redraw();
  }

  private place(): void {
    const name = this.nameInput.value.trim();
    if (!this.state || !/^[A-Za-z0-9_-]{1,60}$/.test(name)) return say("Give the landmark a name: letters, digits, _ and -.", "error");
    const focus = this.state.focus;
    this.landmarks.change((list) => list.place(name, focus));
    this.select(name);
    const next = this.landmarks.known.find((known) => !this.list.landmarks.some((l) => l.name === known));
    if (next) this.nameInput.value = next;
  }

  private rename(): void {
    const from = this.state?.selected;
    if (!from) return say("Choose a landmark in the list first.", "error");
    try {
      const to = this.nameInput.value.trim();
      this.landmarks.change((list) => list.rename(from, to));
      this.select(to);
    } catch (error) {
      say((error as Error).message, "error");
    }
  }

  private step(way: "undo" | "redo"): void {
    this.landmarks.change((list) => list[way]());
  }

  private showPins(): void {
    if (this.state) this.state.pins = this.pins.pins;
    this.redraw();
  }

  private showList(): void {
    if (!this.state) return;
    this.state.landmarks = this.list.landmarks;
    this.undoButton.disabled = !this.list.canUndo;
    this.redoButton.disabled = !this.list.canRedo;
    const entry = (landmark: Landmark): HTMLElement => {
      const chosen = landmark.name === this.state?.selected;
      const name = button(landmark.name, () => this.select(landmark.name), { class: "name", "aria-pressed": String(chosen) });
      const remove = button("×", () => this.landmarks.change((list) => list.remove(landmark.name)), { class: "small", "aria-label": `Remove ${landmark.name}` });
      return make("li", {}, name, remove);
    };
    this.entries.replaceChildren(...this.list.landmarks.map(entry));
    this.redraw();
  }

  private suggestName(): void {
    const { known } = this.landmarks;
    byId("known-landmarks").replaceChildren(...known.map((name) => make("option", { value: name })));
    this.nameInput.value = known.find((name) => !this.list.landmarks.some((l) => l.name === name)) ?? "landmark";
  }
}
