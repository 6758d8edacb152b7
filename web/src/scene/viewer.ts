import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Vec3 } from "../core/case";
import { SurfaceLayer } from "./surface_layer";

export interface Hit {
  layer: SurfaceLayer;
  point: Vec3; // in the world
  corners: [number, number, number];
  weights: Vec3;
}

/** Where the eye stands, as a direction from the middle of what is looked at (LPS). */
export const viewpoints: Record<string, Vec3> = {
  front: [0, -1, 0],
  back: [0, 1, 0],
  left: [1, 0, 0],
  right: [-1, 0, 0],
  above: [0, 0.001, 1],
  below: [0, 0.001, -1],
};

const kSoftwareKey = "coxa-draws-in-software";
const kTurn = Math.PI / 36;
const kMargin = 1.08;

/** True where the browser draws without a graphics card: then smooth edges cost more than they are worth. Asked once a browser. */
function drawsInSoftware(): boolean {
  const known = localStorage.getItem(kSoftwareKey);
  if (known) return known === "yes";
  const software = asksTheDriver();
  localStorage.setItem(kSoftwareKey, software ? "yes" : "no");
  return software;
}
function asksTheDriver(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** A ball that is seen through everything. */
function spot(radius: number, color: number): THREE.Mesh {
  const ball = new THREE.Mesh(new THREE.SphereGeometry(radius, 16, 12), new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true }));
  ball.visible = false;
  ball.renderOrder = 2;
  return ball;
}

/** The 3D view: parallel projection, drawn only when something has changed. */
export class Viewer {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.OrthographicCamera(-100, 100, 100, -100, -2000, 4000);
  readonly renderer: THREE.WebGLRenderer;
  readonly controls: OrbitControls;
  readonly layers = new Map<string, SurfaceLayer>();
  readonly software: boolean;
  onDrawn: ((milliseconds: number) => void) | null = null;
  /** The eye has moved. */
  onCamera: (() => void) | null = null;
  private readonly markers = { place: spot(1, 0xd00000), hit: spot(2.5, 0xff00a0) };
  private readonly plane = new THREE.Plane(new THREE.Vector3(0, 0, -1), 0);
  private clipping = false;
  private halfHeight = 80;
  private queued = false;
  private unfinished: WebGLSync | null = null;
  private wantedAgain = false;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.software = drawsInSoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.software, alpha: true, powerPreference: "high-performance" });
    this.renderer.localClippingEnabled = true;
    this.camera.up.set(0, 0, 1);
    // a light at the eye takes at most a third of the brightness: colours stay comparable with the bar
    const headlight = new THREE.DirectionalLight(0xffffff, 0.35 * Math.PI);
    headlight.position.set(0.3, 0.5, 1);
    this.camera.add(headlight);
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 0.68 * Math.PI), ...Object.values(this.markers));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.cameraMoved());
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  add(layer: SurfaceLayer): void {
    this.remove(layer.name);
    this.layers.set(layer.name, layer);
    this.scene.add(layer.mesh);
    layer.setClipping(this.clipping ? [this.plane] : []);
    this.invalidate();
  }

  remove(name: string): void {
    const old = this.layers.get(name);
    if (!old) return;
    this.scene.remove(old.mesh);
    old.dispose();
    this.layers.delete(name);
  }

  /** Points the eye from a direction at the middle of the given layers, filling the view with them. */
  look(from: Vec3, names: string[] = [...this.layers.keys()], up: Vec3 = [0, 0, 1]): void {
    const box = new THREE.Box3();
    for (const name of names) {
      const layer = this.layers.get(name);
      if (layer) box.expandByObject(layer.mesh);
    }
    if (box.isEmpty()) box.set(new THREE.Vector3(-80, -80, -80), new THREE.Vector3(80, 80, 80));
    const middle = box.getCenter(new THREE.Vector3());
    this.camera.up.set(...up);
    this.camera.zoom = 1;
    this.camera.position.copy(middle).addScaledVector(new THREE.Vector3(...from).normalize(), 600);
    this.controls.target.copy(middle);
    this.controls.update();
    this.camera.updateMatrixWorld();
    // half the extents of the box as the eye sees it, and what is wide for its height
    const seen = box.clone().applyMatrix4(this.camera.matrixWorldInverse).getSize(new THREE.Vector3());
    const parent = (this.canvas.parentElement ?? this.canvas).getBoundingClientRect();
    const aspect = parent.width / Math.max(1, parent.height);
    this.halfHeight = kMargin * 0.5 * Math.max(seen.y, aspect < 1 ? seen.x : seen.x / aspect);
    this.resize();
    this.cameraMoved();
  }

  /** Looks as another view does, at a place that lies `shift` from what that one looks at. */
  lookLike(leader: Viewer, shift: Vec3): void {
    const by = new THREE.Vector3(...shift);
    this.camera.up.copy(leader.camera.up);
    this.camera.zoom = leader.camera.zoom;
    this.camera.position.copy(leader.camera.position).add(by);
    this.controls.target.copy(leader.controls.target).add(by);
    this.halfHeight = leader.halfHeight;
    this.controls.update();
    this.resize();
    this.invalidate();
  }

  private cameraMoved(): void {
    this.invalidate();
    this.onCamera?.();
  }

  setClip(on: boolean, normal: Vec3 = [0, 0, -1], offset = 0): void {
    this.clipping = on;
    this.plane.set(new THREE.Vector3(...normal), offset);
    for (const layer of this.layers.values()) layer.setClipping(on ? [this.plane] : []);
    this.invalidate();
  }

  /** Marks the place looked at, or where bones or labrum are hit; null: neither there nor elsewhere. */
  showMarker(at: Vec3 | null, which: "place" | "hit" = "place"): void {
    const marker = this.markers[which];
    if (!at && !marker.visible) return;
    marker.visible = at !== null;
    if (at) marker.position.set(...at);
    this.canvas.dataset[which] = at ? at.map((c) => c.toFixed(1)).join(" ") : "";
    this.invalidate();
  }

  pick(clientX: number, clientY: number): Hit | null {
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    const shown = [...this.layers.values()].filter((layer) => layer.mesh.visible && layer.mesh.material.opacity > 0.5);
    for (const layer of shown) layer.prepareForPicking();
    const hit = caster
      .intersectObjects(shown.map((layer) => layer.mesh))
      .find(({ point }) => !this.clipping || this.plane.distanceToPoint(point) >= 0);
    if (!hit?.face) return null;
    const layer = this.layers.get(hit.object.name);
    if (!layer) return null;
    const { a, b, c } = hit.face;
    const positions = layer.mesh.geometry.getAttribute("position");
    const corner = (i: number): THREE.Vector3 => new THREE.Vector3().fromBufferAttribute(positions, i);
    const local = layer.mesh.worldToLocal(hit.point.clone());
    const weights = THREE.Triangle.getBarycoord(local, corner(a), corner(b), corner(c), new THREE.Vector3());
    return {
      layer,
      point: [hit.point.x, hit.point.y, hit.point.z],
      corners: [a, b, c],
      weights: weights ? [weights.x, weights.y, weights.z] : [1, 0, 0],
    };
  }

  invalidate(): void {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => this.draw());
  }

  /** The picture at any size, independent of the window, into another. */
  drawInto(context: CanvasRenderingContext2D, x: number, y: number, width: number, height: number, background: string): void {
    const ratio = this.renderer.getPixelRatio();
    this.renderer.setPixelRatio(1);
    this.setFrustum(width, height);
    this.renderer.setSize(width, height, false);
    this.scene.background = new THREE.Color(background);
    this.renderer.render(this.scene, this.camera);
    context.drawImage(this.canvas, x, y); // at once: the canvas does not keep it
    this.scene.background = null;
    this.renderer.setPixelRatio(ratio);
    this.resize();
  }

  private draw(): void {
    this.queued = false;
    // one picture at a time: without a graphics card they would pile up
    if (this.unfinished) {
      this.wantedAgain = true;
      return;
    }
    const start = performance.now();
    this.renderer.render(this.scene, this.camera);
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.unfinished = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.awaitPicture(gl, start);
  }

  /** Asks now and then whether the picture is drawn, so that nothing else has to wait for it. */
  private awaitPicture(gl: WebGL2RenderingContext, start: number): void {
    const fence = this.unfinished;
    if (!fence) return;
    const drawn = gl.clientWaitSync(fence, 0, 0);
    if (drawn === gl.TIMEOUT_EXPIRED) {
      setTimeout(() => this.awaitPicture(gl, start), 16);
      return;
    }
    gl.deleteSync(fence);
    this.unfinished = null;
    this.onDrawn?.(performance.now() - start);
    if (this.wantedAgain) {
      this.wantedAgain = false;
      this.invalidate();
    }
  }

  private setFrustum(width: number, height: number): void {
    const aspect = width / Math.max(1, height);
    const half = aspect < 1 ? this.halfHeight / aspect : this.halfHeight;
    Object.assign(this.camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    this.camera.updateProjectionMatrix();
  }

  private resize(): void {
    const box = (this.canvas.parentElement ?? this.canvas).getBoundingClientRect();
    if (box.width === 0 || box.height === 0) return;
    this.renderer.setPixelRatio(this.software ? 1 : Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(box.width, box.height);
    this.setFrustum(box.width, box.height);
    this.invalidate();
  }

  private onKey(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-kTurn, 0],
      ArrowRight: [kTurn, 0],
      ArrowUp: [0, -kTurn],
      ArrowDown: [0, kTurn],
    };
    const turn = turns[event.key];
    if (turn) {
      const arm = this.camera.position.clone().sub(this.controls.target);
      const side = new THREE.Vector3().crossVectors(this.camera.up, arm).normalize();
      arm.applyAxisAngle(this.camera.up.clone().normalize(), turn[0]).applyAxisAngle(side, turn[1]);
      this.camera.position.copy(this.controls.target).add(arm);
    } else if (event.key === "+" || event.key === "=") {
      this.camera.zoom *= 1.15;
    } else if (event.key === "-") {
      this.camera.zoom /= 1.15;
    } else {
      return;
    }
    event.preventDefault();
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.cameraMoved();
  }
}
