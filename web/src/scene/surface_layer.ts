import * as THREE from "three";
import { acceleratedRaycast, MeshBVH } from "three-mesh-bvh";
import { mapColour, noValue, type MapName, type Rgb } from "../colour/maps";
import { share, type Scale } from "../colour/scale";
import { vertexNormals } from "./normals";

const kColours = 256;

/** Two rows of colours: the map, and grey for vertices without a value. */
function lookupTexture(map: MapName): THREE.DataTexture {
  const data = new Uint8Array(2 * kColours * 4);
  for (let i = 0; i < kColours; ++i) {
    data.set([...mapColour(map, i / (kColours - 1)), 255], 4 * i);
    data.set([...noValue, 255], 4 * (kColours + i));
  }
  const texture = new THREE.DataTexture(data, kColours, 2);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}
const textures = new Map<MapName, THREE.DataTexture>();
function textureOf(map: MapName): THREE.DataTexture {
  let texture = textures.get(map);
  if (!texture) textures.set(map, (texture = lookupTexture(map)));
  return texture;
}

/** One surface in the scene: its own colour, or values looked up in a colour map at every pixel. */
export class SurfaceLayer {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial>;
  private readonly plain: THREE.MeshLambertMaterial;
  private readonly coloured: THREE.MeshLambertMaterial;
  private readonly positions: THREE.BufferAttribute;
  private readonly normals: THREE.BufferAttribute;
  private bvh: MeshBVH | null = null;
  private bvhStale = false;

  constructor(
    readonly name: string,
    positions: Float32Array,
    readonly triangles: Uint32Array,
    colour: Rgb,
  ) {
    const geometry = new THREE.BufferGeometry();
    this.positions = new THREE.BufferAttribute(positions.slice(), 3);
    geometry.setAttribute("position", this.positions);
    geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array((positions.length / 3) * 2), 2));
    geometry.setIndex(new THREE.BufferAttribute(triangles.slice(), 1));
    this.normals = new THREE.BufferAttribute(new Float32Array(positions.length), 3);
    geometry.setAttribute("normal", this.normals);
    vertexNormals(positions, triangles, this.normals.array as Float32Array);
    this.plain = new THREE.MeshLambertMaterial({ color: new THREE.Color(`rgb(${colour.join(",")})`) });
    this.coloured = new THREE.MeshLambertMaterial();
    this.mesh = new THREE.Mesh(geometry, this.plain);
    this.mesh.name = name;
    this.mesh.raycast = acceleratedRaycast;
  }

  get nVertices(): number {
    return this.positions.count;
  }

  update(positions: Float32Array): void {
    (this.positions.array as Float32Array).set(positions);
    this.positions.needsUpdate = true;
    vertexNormals(positions, this.triangles, this.normals.array as Float32Array);
    this.normals.needsUpdate = true;
    this.mesh.geometry.boundingSphere = null;
    this.bvhStale = true;
  }

  /** Colours by values per vertex; null gives the surface its own colour back. */
  colourBy(values: Float32Array | null, scale: Scale | null): void {
    if (!values || !scale) {
      this.mesh.material = this.plain;
      return;
    }
    const uv = this.mesh.geometry.getAttribute("uv") as THREE.BufferAttribute;
    const array = uv.array as Float32Array;
    for (let v = 0; v < values.length; ++v) {
      const at = share(scale, values[v] ?? NaN);
      const known = at === at;
      // half a colour in from both ends, so that the texture's edges do not blend
      array[2 * v] = known ? (0.5 + Math.min(1, Math.max(0, at)) * (kColours - 1)) / kColours : 0.5;
      array[2 * v + 1] = known ? 0.25 : 0.75;
    }
    uv.needsUpdate = true;
    this.coloured.map = textureOf(scale.map);
    this.mesh.material = this.coloured;
  }

  setOpacity(opacity: number): void {
    this.mesh.visible = opacity > 0;
    for (const material of [this.plain, this.coloured]) {
      material.transparent = opacity < 1;
      material.opacity = opacity;
      material.depthWrite = opacity >= 1;
      material.needsUpdate = true;
    }
    // see-through surfaces after those seen through them
    this.mesh.renderOrder = opacity < 1 ? 1 : 0;
  }

  setClipping(planes: THREE.Plane[]): void {
    for (const material of [this.plain, this.coloured]) {
      material.clippingPlanes = planes;
      // closed surfaces show their inside only where they are cut open
      material.side = planes.length > 0 ? THREE.DoubleSide : THREE.FrontSide;
      material.needsUpdate = true;
    }
  }

  /** Row-wise rotation, then translation: as the server gives poses. */
  setPose(pose: number[]): void {
    const at = (i: number): number => pose[i] ?? 0;
    this.mesh.matrixAutoUpdate = false;
    this.mesh.matrix.set(at(0), at(1), at(2), at(9), at(3), at(4), at(5), at(10), at(6), at(7), at(8), at(11), 0, 0, 0, 1);
    this.mesh.matrixWorldNeedsUpdate = true;
  }

  /** Ready for picking: the tree is built when first needed and refitted when the surface has moved. */
  prepareForPicking(): void {
    if (!this.bvh) {
      // the tree reorders its index: give it one of its own
      this.bvh = new MeshBVH(this.mesh.geometry, { indirect: true });
      this.mesh.geometry.boundsTree = this.bvh;
    } else if (this.bvhStale) {
      this.bvh.refit();
    }
    this.bvhStale = false;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.plain.dispose();
    this.coloured.dispose();
  }
}
