#!/usr/bin/env bash
# Builds the browser application into web/dist; does nothing when it is newer than its sources.
set -euo pipefail
cd "$(dirname "$0")/../web"

if [ ! -e node_modules/.package-lock.json ] || [ package-lock.json -nt node_modules/.package-lock.json ]; then
  # a registry without the builds for other platforms makes npm ci refuse the lock file; npm install takes it as it is
  npm ci --no-audit --no-fund --loglevel=silent || npm install --no-save --no-audit --no-fund --loglevel=error
  touch node_modules/.package-lock.json
fi
sources=(index.html package-lock.json vite.config.ts tsconfig.json public src)
if [ ! -e dist/index.html ] || [ -n "$(find "${sources[@]}" -newer dist/index.html -print -quit)" ]; then
  npm run --silent check
  npm run --silent build -- --logLevel warn
fi
