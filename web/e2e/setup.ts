import axe from "axe-core";
import { spawn, type ChildProcess } from "node:child_process";
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { chromium, type Browser, type Page } from "playwright-core";

const root = resolve(new URL(".", import.meta.url).pathname, "../..");
export const coxa = process.env["COXA_BINARY"] ?? resolve(root, "build/release/coxa");
/** Where the case and the pictures are kept between runs. */
export const folder = process.env["COXA_E2E_DIR"] ?? resolve(root, "build/web-e2e");

/** Runs coxa to its end. Not the synchronous way: vitest gives up on a worker that is silent for a minute. */
export function runCoxa(...words: string[]): Promise<void> {
  return new Promise((done, failed) => {
    const child = spawn(coxa, [...words, "--quiet"], { stdio: "inherit" });
    child.on("error", failed);
    child.on("exit", (code) => (code === 0 ? done() : failed(new Error(`coxa ${words[0] ?? ""} ended with ${code}`))));
  });
}

/** A small real case: a virtual patient, its MRI, and the whole chain run on it; kept while its inputs stay. */
export async function prepareCase(): Promise<string> {
  const patient = resolve(folder, "patient");
  if (!existsSync(resolve(patient, "subject.toml"))) {
    mkdirSync(folder, { recursive: true });
    await runCoxa("phantom", "--seed", "3", "--voxel", "1.5", "--out", patient);
    const file = resolve(patient, "subject.toml");
    const text = readFileSync(file, "utf8")
      .replace(/frames = .*/, "frames = 4")
      .replace(/max_tets = .*/, "max_tets = 2000")
      .replace(/pattern = .*/, 'pattern = "flexion"');
    writeFileSync(file, text);
  }
  const result = resolve(folder, "result");
  await runCoxa("run", resolve(patient, "subject.toml"), "--out", result, "--resume");
  for (const left of ["landmarks.mrk.json", "movements"]) rmSync(resolve(result, left), { recursive: true, force: true });
  return result;
}

/** A second result of the same patient: twice the force, one frame less; what both share is taken over. */
export async function prepareOther(): Promise<string> {
  const first = await prepareCase();
  const target = resolve(folder, "other");
  const subject = resolve(folder, "patient/other.toml");
  if (!existsSync(subject)) {
    const text = readFileSync(resolve(folder, "patient/subject.toml"), "utf8").replace(/frames = .*/, "frames = 3");
    writeFileSync(subject, /force_N = .*/.test(text) ? text.replace(/force_N = .*/, "force_N = 1000") : `${text}\n[joint]\nforce_N = 1000\n`);
  }
  if (!existsSync(target)) cpSync(first, target, { recursive: true });
  await runCoxa("run", subject, "--out", target, "--resume");
  return target;
}

/** A copy of the finished result, to be changed. */
export function copyCase(name: string, without: string[]): string {
  const target = resolve(folder, name);
  rmSync(target, { recursive: true, force: true });
  cpSync(resolve(folder, "result"), target, { recursive: true });
  for (const part of without) rmSync(resolve(target, part), { recursive: true, force: true });
  return target;
}

/** An empty folder. */
export function emptyFolder(name: string): string {
  const target = resolve(folder, name);
  rmSync(target, { recursive: true, force: true });
  mkdirSync(target, { recursive: true });
  return target;
}

/** Serious faults that axe finds on the page. */
export async function seriousFaults(page: Page): Promise<string[]> {
  // run in the page by the debugger's own door: the content security policy holds for the page alone
  await page.evaluate(axe.source);
  const found = (await page.evaluate("axe.run()")) as axe.AxeResults;
  return found.violations.filter((v) => v.impact === "serious" || v.impact === "critical").map((v) => `${v.id}: ${v.nodes.map((n) => n.html).join(" | ")}`);
}

/** A subject just begun: the image alone, and landmarks that are still to be placed or are there. */
export function beginSubject(name: string, withLandmarks: boolean): string {
  const target = resolve(folder, name);
  rmSync(target, { recursive: true, force: true });
  mkdirSync(target, { recursive: true });
  cpSync(resolve(folder, "patient/image.nii.gz"), resolve(target, "image.nii.gz"));
  if (withLandmarks) cpSync(resolve(folder, "patient/landmarks.mrk.json"), resolve(target, "landmarks.mrk.json"));
  return target;
}

/** Gives a subject just begun the segmentation of the finished one, which has the same image and landmarks. */
export function takeSegmentation(target: string): void {
  cpSync(resolve(folder, "result/segment"), resolve(target, "segment"), { recursive: true });
}

export interface Served {
  url: string;
  port: number;
  pid: number;
  stop(): Promise<void>;
  /** Ends it at once, as a crash would. */
  kill(): Promise<void>;
}

/** coxa view on a folder. */
export async function serve(subject: string, port = 0, more: string[] = []): Promise<Served> {
  const child: ChildProcess = spawn(coxa, ["view", subject, "--port", String(port), "--json", ...more], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise<string>((done, fail) => {
    let text = "";
    child.stdout?.on("data", (chunk: Buffer) => {
      text += chunk.toString();
      const line = /\{"address":"([^"]+)"\}/.exec(text);
      if (line?.[1]) done(line[1]);
    });
    child.on("exit", (code) => fail(new Error(`coxa view ended with ${code}`)));
  });
  const end = (signal: NodeJS.Signals): Promise<void> =>
    new Promise((done) => {
      if (child.exitCode !== null || child.signalCode !== null) return done();
      child.once("exit", () => done());
      child.kill(signal);
    });
  return { url, port: Number(new URL(url).port), pid: child.pid ?? 0, stop: () => end("SIGTERM"), kill: () => end("SIGKILL") };
}

export function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: process.env["CHROMIUM"] ?? "/usr/bin/chromium",
    // no GPU here: the 3D view is drawn in software; chromium refuses its sandbox as root
    args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"],
  });
}

export interface Opened {
  page: Page;
  faults: string[]; // what the page's console complained of
}

export async function open(browser: Browser, url: string, options: { width?: number; height?: number; dark?: boolean } = {}): Promise<Opened> {
  const page = await browser.newPage({
    viewport: { width: options.width ?? 1280, height: options.height ?? 800 },
    colorScheme: options.dark ? "dark" : "light",
  });
  const faults: string[] = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(message.text());
  });
  page.setDefaultTimeout(60_000);
  await page.goto(url);
  await page.waitForFunction(() => document.body.dataset["ready"] === "yes", null, { timeout: 120_000 });
  return { page, faults };
}

export function picture(name: string): string {
  mkdirSync(resolve(folder, "screenshots"), { recursive: true });
  return resolve(folder, "screenshots", `${name}.png`);
}
