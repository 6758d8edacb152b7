import "./style.css";
import { api } from "../core/api";
import { ComparePage } from "../compare/compare_page";
import type { Case } from "../core/case";
import { byId, make, say } from "../core/dom";
import { Connection } from "../live/connection";
import { FrameStore } from "../scene/frame_store";
import { HipModel } from "../scene/hip_model";
import { Viewer } from "../scene/viewer";
import { volumeFrom, type Volume } from "../slices/volume";
import { ExamPage } from "./exam_page";
import { FieldChoice } from "./field_choice";
import { ImagePage } from "./image_page";
import type { Job } from "./job_panel";
import { Probe } from "./probe";
import { ResultPage } from "./result_page";
import { SceneControls, viewpointButtons } from "./scene_controls";
import { SliceControls } from "./slice_controls";
import { startTheme } from "./theme";

type PageName = "result" | "compare" | "exam" | "image";

/** The application over one folder. */
class App {
  private page: PageName = "result";
  private readonly viewer = new Viewer(byId<HTMLCanvasElement>("scene"));
  private readonly hip = new HipModel(this.viewer);
  private readonly frames: FrameStore;
  private readonly colours: FieldChoice;
  private readonly probe: Probe;
  private readonly result: ResultPage;
  private readonly exam: ExamPage;
  private readonly image: ImagePage;
  private readonly compare: ComparePage;
  private sceneControls: SceneControls | null = null;
  private sliceControls: SliceControls | null = null;
  private volume: Promise<Volume> | null = null;
  private readonly server: Connection;
  private foundNext: string[] = [];
  private fetchingFound = false;
  private readonly tabs = new Map<PageName, HTMLButtonElement>();

  constructor(private readonly info: Case) {
    const send = (message: Record<string, unknown>): boolean => this.server.send(message);
    this.frames = new FrameStore(info.summary?.rows.length ?? 0);
    this.colours = new FieldChoice(info, this.hip, () => this.frames.loaded(), () => this.recolour());
    this.probe = new Probe(this.viewer, this.hip, info);
    this.result = new ResultPage(info, this.viewer, this.hip, this.frames, this.colours, this.probe);
    this.exam = new ExamPage(this.viewer, this.hip, this.colours, this.probe, info.image_pose, (message) => this.server.post(message), info.surfaces.includes("acetabular_labrum"));
    this.image = new ImagePage(info, this.viewer, this.hip, () => this.readVolume(), send);
    this.image.onWindow = (window) => this.sliceControls?.setWindow(window);
    this.compare = new ComparePage(info, this.viewer, this.hip, this.frames, this.colours);
    this.image.jobs.onDone = () => location.reload();
    this.server = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`, {
      state: (state) => this.connection(state === "open"),
      text: (message) => this.hear(message),
      answer: (answer) => this.exam.receive(answer),
    });
  }

  async start(): Promise<void> {
    byId("subject").textContent = `${this.info.name}${this.info.side ? ` · ${this.info.side} hip` : ""}`;
    document.title = `coxa · ${this.info.name}`;
    byId("bar").append(this.colours.bar.element);
    this.buildTabs();
    if (this.frames.count > 0) void this.frames.get(0).catch(() => undefined); // asked for at once; shown below
    await this.hip.load(this.info);
    this.result.surfacesLoaded();
    byId("views").append(...viewpointButtons(() => [this.viewer, ...(this.compare.second ? [this.compare.second.viewer] : [])], this.info.clock));
    this.viewer.look([-0.35, -1, 0.25]);
    if (this.frames.count > 0) this.colours.choose("contact_pressure");
    this.go(this.info.bodies.length === 0 && this.info.surfaces.length === 0 ? "image" : "result");
    await this.result.show(0);
    this.recolour();
    document.body.dataset["ready"] = "yes";
    await this.frames.fetchAhead(() => undefined);
    if (this.page === "result") this.recolour(); // over all frames now
    document.body.dataset["allFrames"] = "yes";
  }

  themeChanged(): void {
    this.result.themeChanged();
    this.compare.themeChanged();
  }

  private buildTabs(): void {
    const names: [PageName, string, boolean][] = [
      ["result", "Result", true],
      ...(this.info.other ? [["compare", "Compare", true] as [PageName, string, boolean]] : []),
      ["exam", "Examine", this.info.live],
      ["image", "Image and landmarks", true],
    ];
    for (const [name, text, there] of names) {
      const tab = make("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": "main" }, text);
      tab.disabled = !there;
      tab.addEventListener("click", () => this.go(name));
      this.tabs.set(name, tab);
    }
    const list = byId("tabs");
    list.append(...this.tabs.values());
    list.addEventListener("keydown", (event) => {
      const order = [...this.tabs].filter(([, tab]) => !tab.disabled).map(([name]) => name);
      const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      const next = order[(order.indexOf(this.page) + by + order.length) % order.length];
      if (by === 0 || !next) return;
      this.go(next);
      this.tabs.get(next)?.focus();
    });
  }

  private go(page: PageName): void {
    if (this.page === "exam" && page !== "exam") this.exam.leave();
    this.result.time?.stop();
    this.compare.time?.stop();
    this.page = page;
    document.body.dataset["page"] = page;
    for (const [name, tab] of this.tabs) {
      tab.setAttribute("aria-selected", String(name === page));
      tab.tabIndex = name === page ? 0 : -1;
    }
    const pages = { result: this.result, compare: this.compare, exam: this.exam, image: this.image };
    const own = pages[page];
    const shared = page === "image" ? [] : [this.colours.element, this.controls().element, ...(page === "compare" ? [] : [this.slices().element])];
    byId("panel").replaceChildren(...(page === "exam" ? [own.panel, ...shared] : [...shared, own.panel]));
    byId("side").replaceChildren(own.side);
    byId("slices").hidden = page !== "image";
    byId("compare3d").hidden = page !== "compare";
    byId("time").hidden = (page !== "result" && page !== "compare") || this.frames.count === 0;
    this.viewer.showMarker(null);
    this.viewer.showMarker(null, "hit");
    this.probe.clear();
    if (page === "result") {
      this.result.time?.mount();
      void this.result.show(this.result.currentFrame);
    }
    if (page === "compare") void this.compare.open((viewer) => this.addView(viewer)).catch((error: Error) => say(error.message, "error"));
    if (page === "exam") this.exam.enter();
    if (page === "image") void this.image.open();
  }

  /** The image, read when first looked at. */
  private readVolume(): Promise<Volume> {
    this.volume ??= api.image().then(volumeFrom);
    this.volume.catch(() => (this.volume = null));
    return this.volume;
  }

  private controls(): SceneControls {
    if (!this.sceneControls) {
      this.sceneControls = new SceneControls({ viewer: this.viewer, centre: this.info.clock?.centre ?? [0, 0, 0] });
      this.sceneControls.onClip = (orientation, offset) => this.sliceControls?.follow(orientation, offset);
    }
    return this.sceneControls;
  }

  private slices(): SliceControls {
    this.sliceControls ??= new SliceControls(this.viewer, this.info.clock?.centre ?? null, () => this.readVolume());
    return this.sliceControls;
  }

  /** The second result's view looks like the first. */
  private addView(viewer: Viewer): void {
    this.controls().add({ viewer, centre: this.compare.second?.info.clock?.centre ?? [0, 0, 0] });
  }

  private recolour(): void {
    if (this.page === "result") this.result.refresh();
    else this.colours.apply();
    if (this.page === "exam") this.exam.fieldChanged();
  }

  private connection(open: boolean): void {
    const line = byId("connection");
    line.dataset["state"] = open ? "open" : "lost";
    line.textContent = open ? "connected" : "connection lost, trying again …";
    if (open && this.page === "exam") this.server.post({ kind: "reconnect" });
  }

  /** Surfaces that a segmentation under way has found so far; what comes while they are fetched is asked for after. */
  private async showFound(names: string[]): Promise<void> {
    this.foundNext = names;
    if (this.fetchingFound) return;
    this.fetchingFound = true;
    while (this.foundNext.length > 0) {
      const wanted = this.foundNext;
      this.foundNext = [];
      const first = this.hip.viewer.layers.size === 0;
      for (const name of wanted) await api.found(name).then((bundle) => this.hip.showFound(name, bundle)).catch(() => undefined); // a new run has begun
      if (first) this.viewer.look([-0.35, -1, 0.25]);
      this.image.updateOutlines();
      document.body.dataset["found"] = [...this.hip.surfaces.keys()].sort().join(" ");
    }
    this.fetchingFound = false;
  }

  private hear(message: Record<string, unknown>): void {
    switch (message["type"]) {
      case "hello":
        this.image.jobs.show(message["job"] as Job);
        break;
      case "job":
        this.image.jobs.show(message as unknown as Job);
        break;
      case "found":
        void this.showFound(message["names"] as string[]);
        break;
      case "landmarks":
        if (this.image.state) void this.image.landmarks.changedElsewhere(String(message["version"]));
        break;
      case "pins":
        if (this.image.state) void this.image.pins.store.changedElsewhere(String(message["version"]));
        break;
      case "image":
        location.reload(); // another window has sent one
        break;
      case "live_error":
        this.exam.fail(Number(message["number"]), String(message["text"]));
        break;
      case "live_broken_off":
        this.server.post({ kind: "fail", number: Number(message["number"]) });
        break;
      case "error":
        say(String(message["text"]), "error");
        break;
    }
  }
}

async function main(): Promise<void> {
  // the token of the address is in a cookie by now
  if (location.search.includes("token=")) history.replaceState(null, "", location.pathname);
  let app: App | null = null;
  startTheme(() => app?.themeChanged());
  try {
    app = new App(await api.case());
    await app.start();
  } catch (error) {
    say((error as Error).message, "error");
    throw error;
  }
}

void main();
