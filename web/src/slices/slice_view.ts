import type { Landmark } from "../core/api";
import type { Vec3 } from "../core/case";
import { make } from "../core/dom";
import { css, structureColours } from "../colour/maps";
import { contour } from "./contour";
import { drawSlice, indexOf, placeOf, sliceAxes, type Orientation, type SliceAxes, type Volume } from "./volume";

/** What all three slice views show. */
export interface SliceState {
  volume: Volume;
  focus: Vec3; // LPS
  window: [number, number];
  landmarks: readonly Landmark[];
  pins: readonly Landmark[]; // that surfaces must pass through
  selected: string | null;
  /** Surfaces in index coordinates. */
  outlines: { name: string; points: Float32Array; triangles: Uint32Array }[];
}

export interface SliceEvents {
  moveFocus(place: Vec3): void;
  changeWindow(window: [number, number]): void;
  selectLandmark(name: string): void;
  moveLandmark(name: string, place: Vec3, done: boolean): void;
}

const kMarkRadius = 0.43; // of the page's letters
const kMarkDepth = 3; // mm from the slice a landmark is still drawn
const letters: Record<Orientation, [left: string, right: string, top: string, bottom: string]> = {
  axial: ["R", "L", "A", "P"],
  coronal: ["R", "L", "S", "I"],
  sagittal: ["A", "P", "S", "I"],
};

/** One linked slice: scroll, click to move the cross-hair, drag landmarks, right drag for window and level. */
export class SliceView {
  readonly element: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly picture = make("canvas");
  private readonly axes: SliceAxes;
  private image: ImageData;
  private queued = false;
  private drag: { kind: "focus" | "window" | "landmark"; name?: string; x: number; y: number; window: [number, number] } | null = null;

  constructor(
    readonly orientation: Orientation,
    private readonly state: SliceState,
    private readonly events: SliceEvents,
  ) {
    this.axes = sliceAxes(state.volume, orientation);
    const { u, v } = this.axes;
    this.picture.width = state.volume.size[u];
    this.picture.height = state.volume.size[v];
    this.image = new ImageData(this.picture.width, this.picture.height);
    this.canvas = make("canvas", {
      tabindex: 0,
      role: "application",
      "aria-label": `${orientation} slice. Arrow keys move the cross-hair, Page Up and Page Down change the slice.`,
    });
    this.element = make("div", { class: "slice" }, this.canvas);
    this.listen();
    new ResizeObserver(() => this.invalidate()).observe(this.element);
  }

  invalidate(): void {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      this.draw();
    });
  }

  /** Milliseconds to make slice k ready to draw. */
  renderSlice(k: number): number {
    const start = performance.now();
    drawSlice(this.state.volume, this.axes, k, this.state.window, this.image.data);
    this.picture.getContext("2d")?.putImageData(this.image, 0, 0);
    return performance.now() - start;
  }

  get sliceCount(): number {
    return this.state.volume.size[this.axes.w];
  }

  /** Height of the page's letters, px: larger on large screens. */
  private get letter(): number {
    return parseFloat(getComputedStyle(document.documentElement).fontSize);
  }
  private get mark(): number {
    return kMarkRadius * this.letter;
  }

  private get index(): Vec3 {
    return indexOf(this.state.volume, this.state.focus);
  }
  private get slice(): number {
    return Math.min(this.sliceCount - 1, Math.max(0, Math.round(this.index[this.axes.w])));
  }

  private placed = { sx: 1, sy: 1, x0: 0, y0: 0 }; // the layout as last drawn

  /** Pixels per voxel along the picture's sides, and where it begins. */
  private layout(): { sx: number; sy: number; x0: number; y0: number } {
    const { spacing, size } = this.state.volume;
    const { u, v } = this.axes;
    const width = this.element.clientWidth;
    const height = this.element.clientHeight;
    const scale = Math.min(width / (size[u] * spacing[u]), height / (size[v] * spacing[v]));
    const sx = scale * spacing[u];
    const sy = scale * spacing[v];
    return { sx, sy, x0: (width - sx * size[u]) / 2, y0: (height - sy * size[v]) / 2 };
  }

  private toScreen(index: ArrayLike<number>, at = 0): [number, number] {
    const { u, v, flipU, flipV } = this.axes;
    const { sx, sy, x0, y0 } = this.placed;
    const i = index[at + u] ?? 0;
    const j = index[at + v] ?? 0;
    const size = this.state.volume.size;
    return [x0 + sx * ((flipU ? size[u] - 1 - i : i) + 0.5), y0 + sy * ((flipV ? size[v] - 1 - j : j) + 0.5)];
  }

  private fromScreen(x: number, y: number): Vec3 {
    const { u, v, w, flipU, flipV } = this.axes;
    const { sx, sy, x0, y0 } = this.layout();
    const size = this.state.volume.size;
    const i = (x - x0) / sx - 0.5;
    const j = (y - y0) / sy - 0.5;
    const index: Vec3 = [0, 0, 0];
    index[u] = Math.min(size[u] - 1, Math.max(0, flipU ? size[u] - 1 - i : i));
    index[v] = Math.min(size[v] - 1, Math.max(0, flipV ? size[v] - 1 - j : j));
    index[w] = this.slice;
    return placeOf(this.state.volume, index);
  }

  private draw(): void {
    const start = performance.now();
    const ratio = window.devicePixelRatio;
    const size = [this.element.clientWidth, this.element.clientHeight].map((side) => Math.max(1, Math.round(side * ratio))) as [number, number];
    // a canvas of the same size is wiped: another would be memory taken and given back for every slice
    if (this.canvas.width !== size[0]) this.canvas.width = size[0];
    if (this.canvas.height !== size[1]) this.canvas.height = size[1];
    const context = this.canvas.getContext("2d");
    if (!context) return;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, ...size);
    context.scale(ratio, ratio);
    this.placed = this.layout();
    const k = this.slice;
    this.renderSlice(k);
    const { sx, sy, x0, y0 } = this.placed;
    context.drawImage(this.picture, x0, y0, sx * this.picture.width, sy * this.picture.height);
    this.drawOutlines(context, k);
    this.drawCross(context);
    this.drawLandmarks(context);
    this.drawPins(context);
    this.drawLetters(context, k);
    this.element.dataset["readyMs"] = (performance.now() - start).toFixed(1);
  }

  private drawOutlines(context: CanvasRenderingContext2D, k: number): void {
    context.lineWidth = 1.5;
    for (const { name, points, triangles } of this.state.outlines) {
      const pieces = contour(points, triangles, this.axes.w, k);
      context.strokeStyle = css(structureColours[name] ?? [255, 255, 255]);
      context.beginPath();
      for (let i = 0; i < pieces.length; i += 6) {
        context.moveTo(...this.toScreen(pieces, i));
        context.lineTo(...this.toScreen(pieces, i + 3));
      }
      context.stroke();
    }
  }

  private drawCross(context: CanvasRenderingContext2D): void {
    const [x, y] = this.toScreen(this.index);
    context.strokeStyle = "rgb(255 255 255 / .55)";
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, this.element.clientHeight);
    context.moveTo(0, y);
    context.lineTo(this.element.clientWidth, y);
    context.stroke();
  }

  private drawLandmarks(context: CanvasRenderingContext2D): void {
    context.font = `${0.86 * this.letter}px system-ui, sans-serif`;
    context.textAlign = "left";
    context.textBaseline = "middle";
    for (const { name, position_lps_mm } of this.state.landmarks) {
      if (this.depth(position_lps_mm) > kMarkDepth) continue;
      const [x, y] = this.toScreen(indexOf(this.state.volume, position_lps_mm));
      const chosen = name === this.state.selected;
      context.lineWidth = chosen ? 3 : 1.5;
      context.strokeStyle = chosen ? "#ffe14d" : "#7df0ff";
      context.beginPath();
      context.arc(x, y, this.mark, 0, 2 * Math.PI);
      context.stroke();
      context.fillStyle = context.strokeStyle;
      context.fillText(name, x + this.mark + 4, y);
    }
  }

  private drawPins(context: CanvasRenderingContext2D): void {
    context.lineWidth = 2;
    context.strokeStyle = context.fillStyle = "#ff9ad5";
    for (const { name, position_lps_mm } of this.state.pins) {
      if (this.depth(position_lps_mm) > kMarkDepth) continue;
      const [x, y] = this.toScreen(indexOf(this.state.volume, position_lps_mm));
      context.strokeRect(x - this.mark + 1, y - this.mark + 1, 2 * this.mark - 2, 2 * this.mark - 2);
      context.fillText(name, x + this.mark + 4, y);
    }
  }

  private drawLetters(context: CanvasRenderingContext2D, k: number): void {
    const width = this.element.clientWidth;
    const height = this.element.clientHeight;
    const [left, right, top, bottom] = letters[this.orientation];
    context.fillStyle = "#ffffff";
    context.shadowColor = "#000000"; // readable on bright fat too
    context.shadowBlur = 4;
    const em = this.letter;
    context.font = `bold ${0.93 * em}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    context.textAlign = "center";
    context.fillText(left, 0.7 * em, height / 2);
    context.fillText(right, width - 0.7 * em, height / 2);
    context.fillText(top, width / 2, 0.8 * em);
    context.fillText(bottom, width / 2, height - 0.8 * em);
    context.textAlign = "left";
    context.font = `${0.86 * em}px system-ui, sans-serif`;
    context.fillText(`${this.orientation} ${k + 1} / ${this.sliceCount}`, 0.6 * em, em);
  }

  /** Distance of a place from this slice, mm. */
  private depth(place: Vec3): number {
    return Math.abs(indexOf(this.state.volume, place)[this.axes.w] - this.slice) * this.state.volume.spacing[this.axes.w];
  }

  private landmarkAt(x: number, y: number): string | null {
    for (const { name, position_lps_mm } of [...this.state.pins, ...this.state.landmarks]) {
      if (this.depth(position_lps_mm) > kMarkDepth) continue;
      const [px, py] = this.toScreen(indexOf(this.state.volume, position_lps_mm));
      if (Math.hypot(px - x, py - y) <= this.mark + 3) return name;
    }
    return null;
  }

  private step(axis: 0 | 1 | 2, by: number): void {
    const index = this.index;
    index[axis] = Math.min(this.state.volume.size[axis] - 1, Math.max(0, index[axis] + by));
    this.events.moveFocus(placeOf(this.state.volume, index));
  }

  private listen(): void {
    const { u, v, w, flipU, flipV } = this.axes;
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.step(w, event.deltaY > 0 ? -1 : 1);
    }, { passive: false });
    this.canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    this.canvas.addEventListener("pointerdown", (event) => this.onDown(event));
    this.canvas.addEventListener("pointermove", (event) => this.onMove(event));
    this.canvas.addEventListener("pointerup", (event) => {
      const { drag } = this;
      this.drag = null;
      if (drag?.kind === "landmark" && drag.name && this.dragged(drag, event)) {
        this.events.moveLandmark(drag.name, this.fromScreen(event.offsetX, event.offsetY), true);
      }
    });
    this.canvas.addEventListener("keydown", (event) => {
      const steps: Record<string, [0 | 1 | 2, number]> = {
        ArrowLeft: [u, flipU ? 1 : -1],
        ArrowRight: [u, flipU ? -1 : 1],
        ArrowUp: [v, flipV ? 1 : -1],
        ArrowDown: [v, flipV ? -1 : 1],
        PageUp: [w, 1],
        PageDown: [w, -1],
      };
      const wanted = steps[event.key];
      if (!wanted) return;
      event.preventDefault();
      this.step(...wanted);
    });
  }

  private onDown(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    const common = { x: event.offsetX, y: event.offsetY, window: [...this.state.window] as [number, number] };
    const name = event.button === 0 ? this.landmarkAt(event.offsetX, event.offsetY) : null;
    if (event.button === 2) {
      this.drag = { kind: "window", ...common };
    } else if (name) {
      this.drag = { kind: "landmark", name, ...common };
      this.events.selectLandmark(name);
    } else {
      this.drag = { kind: "focus", ...common };
      this.events.moveFocus(this.fromScreen(event.offsetX, event.offsetY));
    }
  }

  /** A hand that trembles on a click moves nothing. */
  private dragged(drag: { x: number; y: number }, event: PointerEvent): boolean {
    return Math.hypot(event.offsetX - drag.x, event.offsetY - drag.y) > 2;
  }

  private onMove(event: PointerEvent): void {
    if (!this.drag) return;
    if (this.drag.kind === "focus") this.events.moveFocus(this.fromScreen(event.offsetX, event.offsetY));
    if (this.drag.kind === "landmark" && this.drag.name && this.dragged(this.drag, event)) {
      this.events.moveLandmark(this.drag.name, this.fromScreen(event.offsetX, event.offsetY), false);
    }
    if (this.drag.kind === "window") {
      // across: width; up and down: level
      const [low, high] = this.drag.window;
      const width = Math.max(1e-3, (high - low) * (1 + (event.offsetX - this.drag.x) / 200));
      const level = (low + high) / 2 + ((event.offsetY - this.drag.y) / 200) * (high - low);
      this.events.changeWindow([level - width / 2, level + width / 2]);
    }
  }
}
