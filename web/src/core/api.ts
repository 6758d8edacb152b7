import { decodeBundle, type Bundle } from "./bundle";
import type { Case, Vec3 } from "./case";

export interface Landmark {
  name: string;
  position_lps_mm: Vec3;
}
export interface StoredLandmarks {
  version: string;
  landmarks: Landmark[];
  known: string[];
}
export interface Movement {
  name: string;
  time_s: number[];
  flexion_deg: number[];
  adduction_deg: number[];
  internal_rotation_deg: number[];
}

export class ServerError extends Error {
  constructor(
    readonly status: number,
    text: string,
  ) {
    super(text);
  }
}

async function checked(answer: Response): Promise<Response> {
  if (answer.ok) return answer;
  const text = await answer.text();
  let reason = text;
  try {
    reason = (JSON.parse(text) as { error: string }).error;
  } catch {
    // not JSON: the text itself says why
  }
  throw new ServerError(answer.status, reason);
}

async function json<T>(path: string): Promise<T> {
  return (await (await checked(await fetch(path))).json()) as T;
}
async function bundle(path: string): Promise<Bundle> {
  return decodeBundle(await (await checked(await fetch(path))).arrayBuffer());
}
async function putBytes<T>(path: string, body: Blob): Promise<T> {
  return (await (await checked(await fetch(path, { method: "PUT", body }))).json()) as T;
}
async function put<T>(path: string, body: unknown): Promise<T> {
  return (await (await checked(await fetch(path, { method: "PUT", body: JSON.stringify(body) }))).json()) as T;
}

/** What a result is read from: the folder's own, or that of the second one it is compared with. */
export interface ResultSource {
  case(): Promise<Case>;
  surface(name: string): Promise<Bundle>;
  body(name: string): Promise<Bundle>;
  frame(index: number): Promise<Bundle>;
}

function source(of: string): ResultSource {
  return {
    case: () => json<Case>(`/api/case?${of}`),
    surface: (name) => bundle(`/api/surface?${of}name=${encodeURIComponent(name)}`),
    body: (name) => bundle(`/api/body?${of}name=${encodeURIComponent(name)}`),
    frame: (index) => bundle(`/api/frame?${of}index=${index}`),
  };
}
export const other = source("of=other&");

export const api = {
  ...source(""),
  /** A surface as far as the segmentation under way has found it. */
  found: (name: string) => bundle(`/api/found?name=${encodeURIComponent(name)}`),
  image: () => bundle("/api/image"),
  landmarks: () => json<StoredLandmarks>("/api/landmarks"),
  saveLandmarks: (version: string, landmarks: Landmark[]) =>
    put<StoredLandmarks>("/api/landmarks", { version, landmarks }),
  pins: () => json<StoredLandmarks>("/api/pins"),
  savePins: (version: string, landmarks: Landmark[]) => put<StoredLandmarks>("/api/pins", { version, landmarks }),
  upload: (batch: string, name: string, bytes: Blob) =>
    putBytes<{ files: number; bytes: number }>(`/api/upload?batch=${batch}&name=${encodeURIComponent(name)}`, bytes),
  takeImage: (wanted: { batch: string; side: string; movement: string; series?: string }) => put<{ image: string }>("/api/image", wanted),
  saveMovement: (movement: Movement) => put<{ file: string }>("/api/movement", movement),
};
