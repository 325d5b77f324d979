#!/usr/bin/env bash
# Makes the pictures of the README anew: report.png, graph.png and top.png, beside this file.
# Needs what `cargo build --release` makes (or another steadfast, named by STEADFAST, with its
# libraries beside it) and Chromium (or another browser that knows its options, named by CHROMIUM).
set -euo pipefail
pictures="$(cd "$(dirname "$0")" && pwd)"
cd "$pictures/../.."
steadfast="$(realpath "${STEADFAST:-target/release/steadfast}")"
chromium="${CHROMIUM:-chromium}"
for program in "$steadfast" "$chromium"; do
  command -v "$program" >/dev/null || { echo "$0: there is no $program" >&2; exit 1; }
done

# Everything that is made on the way; also where the running robot is found, so that it is no other.
work="$(mktemp -d)"
export XDG_RUNTIME_DIR="$work"
robot=
leave() {
  if [ -n "$robot" ]; then kill "$robot" 2>/dev/null || true; wait "$robot" || true; fi
  rm -rf "$work"
}
trap leave EXIT

application=profiles/applications/target_following.xml
rules=rules/target_following.xml

# shot PAGE WIDTH HEIGHT PICTURE: what a browser shows of a page.
shot() {
  timeout 60 "$chromium" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage \
    --hide-scrollbars --user-data-dir="$work/browser" --window-size="$2,$3" \
    --screenshot="$pictures/$4" "file://$1" >"$work/browser.log" 2>&1 ||
    { cat "$work/browser.log" >&2; exit 1; }
}

# drawing SVG PICTURE: a drawing at its own size.
drawing() {
  local size
  size="$(grep -o -m 1 'viewBox="[^"]*"' "$1" | tr -d '"' | cut -d' ' -f3-4)"
  printf '<!DOCTYPE html><style>body{margin:0}img{display:block}</style><img src="%s" width="%.0f" height="%.0f">' \
    "$(basename "$1")" $size >"$work/drawing.html"
  shot "$work/drawing.html" $(printf '%.0f %.0f' $size) "$2"
}

cat >"$work/faults.xml" <<'XML'
<fault_injections application="target_following">
  <inject at="3s" component="left_sonar" port="range" fault="out_of_range" value="0" for="60ms"/>
  <inject at="8s" component="obstacle_avoidance" fault="segfault"/>
  <inject at="13s" component="path_planner" fault="panic"/>
</fault_injections>
XML

"$steadfast" run "$application" --rules "$rules" --inject "$work/faults.xml" --clock simulated --seed 1 \
  --for 120s --events "$work/events.jsonl" --summary "$work/summary.json" \
  --picture "$work/drive.svg" --record "$work/run.mcap" >/dev/null
(cd "$work" && "$steadfast" report events.jsonl run.mcap --summary summary.json --picture drive.svg \
  --output report.html)
shot "$work/report.html" 1000 1560 report.png

"$steadfast" graph "$application" --rules "$rules" --output "$work/graph.svg"
drawing "$work/graph.svg" graph.png

# On a machine that has other things to do, real time is not what the model of the drive expects: rules
# without one.
rules=rules/scenarios/crash_restored_by_reset/rules.xml
"$steadfast" run "$application" --rules "$rules" --inject "$work/faults.xml" --clock real --seed 1 \
  --for 60s >"$work/run.log" 2>&1 &
robot=$!
sleep 14
"$steadfast" top --picture "$work/top.svg" --size 110x30
drawing "$work/top.svg" top.png

ls -l "$pictures"/{report,graph,top}.png
