import { api } from "../core/api";
import type { Bundle } from "../core/bundle";

/** The movement's frames: each fetched once, kept, and the rest fetched ahead while nothing else is asked for. */
export class FrameStore {
  private readonly frames = new Map<number, Promise<Bundle>>();
  private readonly ready = new Map<number, Bundle>();

  constructor(
    readonly count: number,
    private readonly fetchFrame: (index: number) => Promise<Bundle> = (index) => api.frame(index),
  ) {}

  get(index: number): Promise<Bundle> {
    let frame = this.frames.get(index);
    if (!frame) {
      frame = this.fetchFrame(index).then((bundle) => {
        this.ready.set(index, bundle);
        return bundle;
      });
      frame.catch(() => this.frames.delete(index));
      this.frames.set(index, frame);
    }
    return frame;
  }

  /** At once, where it is here already. */
  peek(index: number): Bundle | null {
    return this.ready.get(index) ?? null;
  }

  loaded(): Bundle[] {
    return [...this.ready.entries()].sort(([a], [b]) => a - b).map(([, bundle]) => bundle);
  }

  async fetchAhead(onEach: (done: number) => void): Promise<void> {
    for (let i = 0; i < this.count; ++i) {
      await this.get(i);
      onEach(i + 1);
    }
  }
}
