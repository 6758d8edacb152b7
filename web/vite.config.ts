import { defineConfig } from "vite";

// the server's content security policy allows files of its own alone: nothing is inlined
export default defineConfig({
  base: "/",
  worker: { format: "es" },
  build: { target: "es2022", assetsInlineLimit: 0, modulePreload: false, chunkSizeWarningLimit: 1500 },
  server: { proxy: { "/api": "http://127.0.0.1:8080", "/files": "http://127.0.0.1:8080", "/ws": { target: "ws://127.0.0.1:8080", ws: true } } },
});
