import type { Landmark } from "../core/api";
import type { Vec3 } from "../core/case";

/** Landmarks with undo and redo; every change is one step. */
export class LandmarkList {
  private past: Landmark[][] = [];
  private future: Landmark[][] = [];
  private now: Landmark[] = [];

  get landmarks(): readonly Landmark[] {
    return this.now;
  }
  get canUndo(): boolean {
    return this.past.length > 0;
  }
  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** Replaces all by what is stored; forgets the steps. */
  reset(landmarks: Landmark[]): void {
    this.now = landmarks.map((l) => ({ ...l }));
    this.past = [];
    this.future = [];
  }

  /** Places a landmark, or moves it where it is there already. */
  place(name: string, position: Vec3): void {
    const others = this.now.filter((l) => l.name !== name);
    this.change([...others, { name, position_lps_mm: [...position] }]);
  }

  remove(name: string): void {
    if (this.now.some((l) => l.name === name)) this.change(this.now.filter((l) => l.name !== name));
  }

  /** @throws Error for a name that is taken or no word */
  rename(from: string, to: string): void {
    if (from === to) return;
    if (!/^[A-Za-z0-9_-]{1,60}$/.test(to)) throw new Error(`"${to}" is no name: letters, digits, _ and - are`);
    if (this.now.some((l) => l.name === to)) throw new Error(`there is a landmark ${to} already`);
    this.change(this.now.map((l) => (l.name === from ? { ...l, name: to } : l)));
  }

  undo(): void {
    const last = this.past.pop();
    if (!last) return;
    this.future.push(this.now);
    this.now = last;
  }

  redo(): void {
    const next = this.future.pop();
    if (!next) return;
    this.past.push(this.now);
    this.now = next;
  }

  private change(next: Landmark[]): void {
    this.past.push(this.now);
    this.future = [];
    this.now = next.sort((a, b) => (a.name < b.name ? -1 : 1));
  }
}
