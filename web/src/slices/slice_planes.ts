import * as THREE from "three";
import type { Vec3 } from "../core/case";
import type { Viewer } from "../scene/viewer";
import { drawSlice, indexOf, placeOf, sliceAxes, type Orientation, type SliceAxes, type Volume } from "./volume";

interface Plane {
  axes: SliceAxes;
  mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  texture: THREE.DataTexture;
  slice: number; // drawn now; -1 for none
}

/** Corners of slice k in the picture's order: left to right, then top to bottom. */
export function sliceCorners(volume: Volume, { u, v, w, flipU, flipV }: SliceAxes, k: number): [Vec3, Vec3, Vec3, Vec3] {
  const corner = (right: boolean, bottom: boolean): Vec3 => {
    const index: Vec3 = [0, 0, 0];
    index[u] = right === flipU ? -0.5 : volume.size[u] - 0.5;
    index[v] = bottom === flipV ? -0.5 : volume.size[v] - 0.5;
    index[w] = k;
    return placeOf(volume, index);
  };
  return [corner(false, false), corner(true, false), corner(false, true), corner(true, true)];
}

/** Slices of the MRI standing in the 3D view where they were taken. */
export class SlicePlanes {
  private readonly planes = new Map<Orientation, Plane>();
  private window: [number, number];

  constructor(
    private readonly viewer: Viewer,
    private readonly volume: Volume,
  ) {
    this.window = [...volume.window];
  }

  /** The slice of an orientation that holds a place; null takes it away. */
  show(orientation: Orientation, place: Vec3 | null): void {
    const plane = this.planes.get(orientation) ?? (place ? this.make(orientation) : undefined);
    if (!plane) return;
    plane.mesh.visible = place !== null;
    if (place) this.draw(plane, place);
    this.viewer.invalidate();
  }

  setWindow(window: [number, number]): void {
    this.window = window;
    for (const plane of this.planes.values()) {
      if (plane.slice >= 0) this.fill(plane);
    }
    this.viewer.invalidate();
  }

  private make(orientation: Orientation): Plane {
    const axes = sliceAxes(this.volume, orientation);
    const [width, height] = [this.volume.size[axes.u], this.volume.size[axes.v]];
    const texture = new THREE.DataTexture(new Uint8Array(4 * width * height), width, height);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.magFilter = THREE.LinearFilter;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(12), 3));
    geometry.setAttribute("uv", new THREE.BufferAttribute(Float32Array.from([0, 0, 1, 0, 0, 1, 1, 1]), 2));
    geometry.setIndex([0, 2, 1, 1, 2, 3]);
    const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide, toneMapped: false }));
    mesh.frustumCulled = false; // its corners move
    this.viewer.scene.add(mesh);
    const plane = { axes, mesh, texture, slice: -1 };
    this.planes.set(orientation, plane);
    return plane;
  }

  private draw(plane: Plane, place: Vec3): void {
    const { w } = plane.axes;
    const k = Math.min(this.volume.size[w] - 1, Math.max(0, Math.round(indexOf(this.volume, place)[w])));
    if (k === plane.slice) return;
    plane.slice = k;
    const positions = plane.mesh.geometry.getAttribute("position") as THREE.BufferAttribute;
    sliceCorners(this.volume, plane.axes, k).forEach((corner, i) => positions.setXYZ(i, ...corner));
    positions.needsUpdate = true;
    this.fill(plane);
  }

  private fill(plane: Plane): void {
    const data = plane.texture.image.data as Uint8Array;
    drawSlice(this.volume, plane.axes, plane.slice, this.window, new Uint8ClampedArray(data.buffer));
    plane.texture.needsUpdate = true;
  }
}
