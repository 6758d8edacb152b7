import { defineConfig } from "vitest/config";

export default defineConfig({
  test: { include: ["e2e/**/*.test.ts"], testTimeout: 120_000, hookTimeout: 900_000, fileParallelism: false,
    expect: { poll: { timeout: 30_000, interval: 100 } } },
});
