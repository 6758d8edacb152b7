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
async function put<T>(path: string, body: unknown): Promise<T> {
  return (await (await checked(await fetch(path, { method: "PUT", body: JSON.stringify(body) }))).json()) as T;
}

export const api = {
  case: () => json<Case>("/api/case"),
  surface: (name: string) => bundle(`/api/surface?name=${encodeURIComponent(name)}`),
  body: (name: string) => bundle(`/api/body?name=${encodeURIComponent(name)}`),
  frame: (index: number) => bundle(`/api/frame?index=${index}`),
  image: () => bundle("/api/image"),
  landmarks: () => json<StoredLandmarks>("/api/landmarks"),
  saveLandmarks: (version: string, landmarks: Landmark[]) =>
    put<StoredLandmarks>("/api/landmarks", { version, landmarks }),
  saveMovement: (movement: Movement) => put<{ file: string }>("/api/movement", movement),
};
