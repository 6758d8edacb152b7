import { structureColours } from "../colour/maps";
import type { Scale } from "../colour/scale";
import { api, type ResultSource } from "../core/api";
import { floats, triangles, type Bundle } from "../core/bundle";
import type { Case } from "../core/case";
import { SurfaceLayer } from "./surface_layer";
import type { Viewer } from "./viewer";

const kBodies = ["acetabular", "femoral"] as const;
export type BodyName = (typeof kBodies)[number];
const layerOf = (body: BodyName): string => `${body}_cartilage`;
const kStill = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];

/** The hip in the scene: bones and cartilages, at a frame of the movement or as the live solver has them. */
export class HipModel {
  readonly bodies = new Map<BodyName, Bundle>();
  readonly surfaces = new Map<string, Bundle>();
  private state: Bundle | null = null; // what moved the hip last

  constructor(
    readonly viewer: Viewer,
    private readonly source: ResultSource = api,
  ) {}

  async load(info: Case): Promise<void> {
    const meshed = info.bodies as BodyName[];
    const wanted = info.surfaces.filter((name) => !meshed.some((body) => layerOf(body) === name));
    await Promise.all([
      ...meshed.map(async (body) => this.bodies.set(body, await this.source.body(body))),
      ...wanted.map(async (name) => this.surfaces.set(name, await this.source.surface(name))),
    ]);
    for (const name of [...wanted].sort()) this.addLayer(name, this.surfaces.get(name));
    for (const body of meshed) this.addLayer(layerOf(body), this.bodies.get(body));
  }

  /** A surface as a segmentation under way has found it, in place of what was there. */
  showFound(name: string, bundle: Bundle): void {
    this.bodies.delete(name.replace("_cartilage", "") as BodyName); // was meshed of an older surface
    this.surfaces.set(name, bundle);
    this.addLayer(name, bundle);
    this.viewer.invalidate();
  }

  clear(): void {
    for (const name of [...this.viewer.layers.keys()]) this.viewer.remove(name);
    this.bodies.clear();
    this.surfaces.clear();
    this.state = null;
  }

  /** Moves the hip to a frame: with positions where it has a result, else the femur's pose alone. */
  apply(frame: Bundle): void {
    this.state = frame;
    const pose = (frame.meta["femur_pose"] as number[] | undefined) ?? kStill;
    this.viewer.layers.get("femur")?.setPose(pose);
    for (const body of kBodies) {
      const layer = this.viewer.layers.get(layerOf(body));
      const reference = this.bodies.get(body);
      if (!layer || !reference) continue;
      const solved = frame.arrays.has(`${body}.positions`);
      layer.setPose(!solved && body === "femoral" ? pose : kStill);
      layer.update(floats(solved ? frame : reference, solved ? `${body}.positions` : "positions"));
    }
    this.viewer.invalidate();
  }

  /** Values of a field on a layer as it stands; null where it has none. */
  values(layer: string, field: string, frame: Bundle | null = this.state): Float32Array | null {
    const body = kBodies.find((b) => layerOf(b) === layer);
    const found = body
      ? (frame?.arrays.get(`${body}.${field}`) ?? this.bodies.get(body)?.arrays.get(field))
      : this.surfaces.get(layer)?.arrays.get(field);
    return found instanceof Float32Array ? found : null;
  }

  /** All values of a field over frames, or as the hip stands. */
  arrays(field: string, frames: Bundle[]): Float32Array[] {
    const arrays: Float32Array[] = [];
    for (const layer of this.viewer.layers.keys()) {
      for (const frame of frames.length > 0 ? frames : [this.state]) {
        const values = this.values(layer, field, frame);
        if (values) arrays.push(values);
      }
    }
    return arrays;
  }

  colour(field: string | null, scale: Scale | null): void {
    for (const [name, layer] of this.viewer.layers) layer.colourBy(field ? this.values(name, field) : null, scale);
    this.viewer.invalidate();
  }

  private addLayer(name: string, bundle: Bundle | undefined): void {
    if (!bundle) return;
    this.viewer.add(new SurfaceLayer(name, floats(bundle, "positions"), triangles(bundle), structureColours[name] ?? [153, 153, 153]));
  }
}
