import { ServerError, type Landmark, type StoredLandmarks } from "../core/api";
import { say } from "../core/dom";
import { LandmarkList } from "./landmark_list";

export interface PointRequests {
  what: string; // for people: "Landmarks", "Pins"
  load(): Promise<StoredLandmarks>;
  save(version: string, points: Landmark[]): Promise<StoredLandmarks>;
}

/** Named points that are saved at every change, with undo; another window's changes are noticed. */
export class PointStore {
  readonly list = new LandmarkList();
  known: string[] = [];
  private version = "";
  private saving = false;
  private saveAgain = false;

  constructor(
    private readonly requests: PointRequests,
    private readonly onChange: () => void,
    private readonly tell: (text: string, kind?: "plain" | "error") => void = say,
  ) {}

  get isSaving(): boolean {
    return this.saving;
  }

  async load(): Promise<void> {
    const stored = await this.requests.load();
    this.version = stored.version;
    this.known = stored.known;
    this.list.reset(stored.landmarks);
    this.onChange();
  }

  change(change: (list: LandmarkList) => void): void {
    change(this.list);
    this.onChange();
    void this.save();
  }

  /** Another window has changed them. */
  async changedElsewhere(version: string): Promise<void> {
    if (this.saving || version === this.version) return;
    await this.load();
    this.tell(`${this.requests.what} were changed in another window.`);
  }

  /** One save at a time; a change during one is saved after it. */
  private async save(): Promise<void> {
    this.saveAgain = true;
    if (this.saving) return;
    this.saving = true;
    try {
      while (this.saveAgain) {
        this.saveAgain = false;
        this.version = (await this.requests.save(this.version, [...this.list.landmarks])).version;
      }
      this.tell(`${this.requests.what} saved.`);
    } catch (error) {
      this.tell((error as Error).message, "error");
      if (error instanceof ServerError && error.status === 409) await this.load();
    } finally {
      this.saving = false;
    }
  }
}
