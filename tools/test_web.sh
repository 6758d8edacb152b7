#!/usr/bin/env bash
# Tests of the browser application: its logic, then each of its jobs in chromium on a small real case, which is kept in
# BUILD/web-e2e with the screenshots. Usage: tools/test_web.sh BUILD
set -euo pipefail
build=$(cd "$1" && pwd)
cd "$(dirname "$0")/../web"
npm run --silent check
npm run --silent test
COXA_BINARY="$build/coxa" COXA_E2E_DIR="$build/web-e2e" npm run --silent e2e
