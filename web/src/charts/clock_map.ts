import { mapColour, type MapName, type Rgb } from "../colour/maps";
import { share, type Scale } from "../colour/scale";
import type { Clock, Vec3 } from "../core/case";
import { make } from "../core/dom";
import { shortNumber } from "../core/numbers";
import { fillTriangles } from "./raster";
import { flattened, sectorMeans, sectorOf } from "./clock";

const kArticular = 2; // FacetTag::articular_side
const kLevels = 256; // of colour
const kShown = 1.25; // right angles from the pole at the edge of the picture

/** Colours of the map from end to end, then that of no value; as pixels. */
function colourTable(map: MapName): Uint32Array {
  const pixel = ([r, g, b]: Rgb): number => (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;
  return Uint32Array.from({ length: kLevels + 2 }, (_, i) => pixel(mapColour(map, i > kLevels ? NaN : i / kLevels)));
}

/** The acetabular joint surface flattened on a clock face, coloured by a field, with means by hour below. */
export class ClockMap {
  readonly element = make("section", { class: "clock", "aria-label": "Clock face of the acetabulum" });
  private readonly canvas = make("canvas", { role: "img", "aria-label": "Map of the acetabular cartilage" });
  private readonly body = make("tbody");
  private readonly title = make("h2", {}, "Acetabulum, clock face");
  private readonly note = make("p", { class: "note" });
  private corners: number[] = []; // three vertices each
  private flat: Float32Array = new Float32Array();
  private sectors: Uint8Array = new Uint8Array();
  private vertices: number[] = [];
  private shown: { values: Float32Array; scale: Scale } | null = null;

  constructor(side: string) {
    this.note.textContent =
      side === "left"
        ? "12 superior, 3 anterior: a left hip drawn like a right one (mirrored)."
        : "12 superior, 3 anterior, as seen from the femur on a right hip.";
    const head = make("tr", {}, make("th", { scope: "col" }, "Hour"), make("th", { scope: "col" }, "Mean"), make("th", { scope: "col" }, "Highest"));
    const table = make("table", {}, make("caption", {}, "Values by hour"), make("thead", {}, head), this.body);
    const details = make("details", {}, make("summary", {}, "Values by hour"), table);
    this.element.append(this.title, this.canvas, this.note, details);
    new ResizeObserver(() => this.draw()).observe(this.element);
  }

  setSurface(clock: Clock, positions: Float32Array, triangles: Uint32Array, tags: Uint8Array): void {
    const n = positions.length / 3;
    this.flat = new Float32Array(2 * n);
    this.sectors = new Uint8Array(n);
    for (let v = 0; v < n; ++v) {
      const place: Vec3 = [positions[3 * v] ?? 0, positions[3 * v + 1] ?? 0, positions[3 * v + 2] ?? 0];
      this.flat.set(flattened(clock, place), 2 * v);
      this.sectors[v] = sectorOf(clock, place);
    }
    this.corners = [];
    for (let t = 0; t < tags.length; ++t) {
      if (tags[t] === kArticular) this.corners.push(...triangles.subarray(3 * t, 3 * t + 3));
    }
    this.vertices = [...new Set(this.corners)];
  }

  show(values: Float32Array | null, scale: Scale | null): void {
    this.shown = values && scale ? { values, scale } : null;
    this.title.textContent = scale ? `Acetabulum: ${scale.label}` : "Acetabulum, clock face";
    this.draw();
    const means = values ? sectorMeans(this.sectors, this.vertices, values) : [];
    this.body.replaceChildren(
      ...means.map((sector, hour) =>
        make("tr", {}, make("th", { scope: "row" }, String(hour === 0 ? 12 : hour)), make("td", {}, shortNumber(sector.mean)), make("td", {}, shortNumber(sector.high))),
      ),
    );
  }

  private draw(): void {
    const size = Math.min(this.element.clientWidth, 0.3 * window.innerHeight);
    if (size < 20) return;
    const ratio = window.devicePixelRatio;
    this.canvas.width = this.canvas.height = Math.round(size * ratio);
    this.canvas.style.width = this.canvas.style.height = `${size}px`;
    const context = this.canvas.getContext("2d");
    if (!context) return;
    const middle = size / 2;
    const unit = (middle - 16) / kShown;
    if (this.shown) this.drawTriangles(context, this.canvas.width, ratio * unit, this.shown);
    context.scale(ratio, ratio);
    const style = getComputedStyle(this.element);
    context.strokeStyle = style.getPropertyValue("--line");
    context.fillStyle = style.getPropertyValue("--ink");
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize);
    context.font = `${0.85 * rem}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const angle of [1 / 3, 2 / 3, 1]) {
      context.beginPath();
      context.arc(middle, middle, unit * angle, 0, 2 * Math.PI);
      context.stroke();
    }
    for (let hour = 1; hour <= 12; ++hour) {
      const turn = (hour / 12) * 2 * Math.PI;
      context.fillText(String(hour), middle + Math.sin(turn) * (middle - 0.6 * rem), middle - Math.cos(turn) * (middle - 0.6 * rem));
    }
  }

  private drawTriangles(context: CanvasRenderingContext2D, size: number, unit: number, shown: { values: Float32Array; scale: Scale }): void {
    const xy = new Float32Array(this.flat.length);
    const shares = new Float32Array(shown.values.length);
    for (let v = 0; v < shares.length; ++v) {
      xy[2 * v] = size / 2 + unit * (this.flat[2 * v] ?? 0);
      xy[2 * v + 1] = size / 2 - unit * (this.flat[2 * v + 1] ?? 0);
      shares[v] = share(shown.scale, shown.values[v] ?? NaN);
    }
    const image = context.createImageData(size, size);
    fillTriangles(new Uint32Array(image.data.buffer), size, xy, this.corners, shares, colourTable(shown.scale.map));
    context.putImageData(image, 0, 0);
  }
}
