#!/bin/sh
# Builds the tests of the libraries named and runs them under the address and undefined-behaviour sanitizers.
set -e
cd "$(dirname "$0")/.."
cmake --preset asan > /dev/null
cmake --build build/asan --target $(printf '%s_test ' "$@")
# undefined behaviour is otherwise only printed
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
for library in "$@"; do
  echo "sanitizers: $library"
  "build/asan/${library}_test" --gtest_brief=1
done
