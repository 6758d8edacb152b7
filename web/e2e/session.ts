import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll } from "vitest";
import { launch, open, prepareCase, serve, type Served } from "./setup";

// what the tests of one file work with; importers see each as it is now
export let folder: string;
export let server: Served;
export let browser: Browser;
export let page: Page;
export let faults: string[];

/** Serves a folder in place of the one before, and opens its page. */
export async function show(next: string, more: string[] = []): Promise<void> {
  await server?.stop();
  folder = next;
  server = await serve(folder, 0, more);
  ({ page, faults } = await open(browser, server.url));
}

/** The server again, where it was. */
export async function serveAgain(): Promise<void> {
  server = await serve(folder, server.port);
}

/** Before a file's tests the finished case is made, chromium started, and `begin` called, which shows a folder; all is ended after them. */
export function session(begin: (finished: string) => Promise<void>): void {
  beforeAll(async () => {
    const finished = await prepareCase();
    browser = await launch();
    await begin(finished);
  });
  afterAll(async () => {
    await browser?.close();
    await server?.stop();
  });
}
