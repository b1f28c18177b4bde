#!/usr/bin/env bash
# The real window on a virtual screen with software GL: starts it, presses keys, looks whether the picture
# changes, and closes it. Needs no GPU and no desktop; without the programs below it says "skipped".
#
#   cargo build --release && bash tests/e2e/run.sh
#
# BACKLIT_BIN   the program   [default: target/release/backlit]
# BACKLIT_TAKE  a take to open besides the built-in one   [default: none]
# BACKLIT_SHOTS folder for the screenshots   [default: they are thrown away]
#
# Debian packages: xvfb xdotool imagemagick libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0 libegl1
# libgl1-mesa-dri
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
binary=${BACKLIT_BIN:-${CARGO_TARGET_DIR:-$root/target}/release/backlit}

for program in Xvfb xdotool import compare identify; do
    if ! command -v "$program" >/dev/null; then
        echo "skipped: $program is not installed"
        exit 0
    fi
done
if [[ ! -x $binary ]]; then
    echo "failed: there is no $binary; build it with cargo build --release" >&2
    exit 1
fi

binary=$(realpath "$binary")
take=${BACKLIT_TAKE:+$(realpath "$BACKLIT_TAKE")}
work=$(mktemp -d)
shots=$(realpath -m "${BACKLIT_SHOTS:-$work/shots}")
mkdir -p "$shots" "$work/run"
chmod 700 "$work/run"
server=
program=
clean_up() {
    # Whoever is gone already needs no ending, and must not keep the rest from it.
    [[ -n $program ]] && kill "$program" 2>/dev/null || true
    [[ -n $server ]] && kill "$server" 2>/dev/null || true
    cd / && rm -rf "$work"
}
trap clean_up EXIT

fail() {
    echo "failed: $*" >&2
    [[ -s $work/stderr ]] && sed 's/^/  stderr: /' "$work/stderr" >&2
    exit 1
}

# A display number that is free, chosen by the server.
Xvfb -displayfd 3 -screen 0 1600x1000x24 -nolisten tcp -noreset 3>"$work/display" 2>"$work/server" &
server=$!
for _ in {1..100}; do
    [[ -s $work/display ]] && break
    sleep 0.1
done
[[ -s $work/display ]] || fail "the virtual screen does not start"
DISPLAY=:$(<"$work/display")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1
export HOME=$work XDG_DATA_HOME=$work/data XDG_CONFIG_HOME=$work/config XDG_RUNTIME_DIR=$work/run
unset WAYLAND_DISPLAY WAYLAND_SOCKET
cd "$work"

alive() { kill -0 "$program" 2>/dev/null; }

# start [ARGUMENT…]: starts the program and waits for its window.
start() {
    "$binary" "$@" >"$work/stdout" 2>"$work/stderr" &
    program=$!
    window=
    for _ in {1..300}; do
        alive || fail "the program ended before its window was there"
        window=$(xdotool search --onlyvisible --pid "$program" 2>/dev/null | head -n 1) || true
        [[ -n $window ]] && break
        sleep 0.1
    done
    [[ -n $window ]] || fail "no window within 30 s"
    xdotool mousemove 1 1 windowfocus "$window"
    sleep 1
}

# picture NAME: waits until the window stays as it is, and keeps its picture.
picture() {
    local before=none same=0 now tries
    for tries in {1..240}; do
        sleep 0.5
        alive || fail "$1: the program ended"
        import -window root "$shots/$1.png"
        now=$(identify -format '%#' "$shots/$1.png")
        # The same three times in a row.
        if [[ $now == "$before" ]]; then
            ((++same < 2)) || break
        else
            same=0
        fi
        before=$now
    done
    ((tries < 240)) || fail "$1: the window does not come to rest"
}

# differs OTHER NAME COUNT: at least COUNT pixels must differ by more than noise.
differs() {
    local count
    count=$(compare -metric AE -fuzz 4% "$shots/$1.png" "$shots/$2.png" null: 2>&1 || true)
    awk -v count="$count" -v least="$3" 'BEGIN { exit !(count + 0 >= least) }' ||
        fail "$2 looks like $1: $count pixels differ, at least $3 should"
    echo "ok: $2 ($count pixels differ from $1)"
}

# press KEYS NAME OTHER COUNT: presses keys, waits, and compares with the picture before.
press() {
    xdotool key "$1"
    picture "$2"
    differs "$3" "$2" "$4"
}

# quit WHAT: closes the window by its own command; nothing may have been complained about.
quit() {
    xdotool key ctrl+q
    for _ in {1..100}; do
        alive || break
        sleep 0.1
    done
    alive && fail "$1: Ctrl+Q does not close the window"
    local code=0
    wait "$program" || code=$?
    program=
    ((code == 0)) || fail "$1: the program ended with $code"
    [[ ! -s $work/stderr ]] || fail "$1: the program complained"
    echo "ok: $1 is closed, nothing was complained about"
}

import -window root "$shots/nothing.png"
start
picture start
differs nothing start 800000
press space step start 2000
press Return run step 2000
press ctrl+Return track run 2000
press F2 debug track 100000
press ctrl+b no_panel debug 100000
xdotool windowsize "$window" 1100 700
picture small
differs no_panel small 100000
press ctrl+b small_panel small 50000
press F1 small_pose small_panel 50000
press F2 small_debug small_pose 50000
quit "the built-in take"

# What was left unsaved is offered, and stays as long as nobody has chosen.
unsaved=$work/data/backlit/unsaved.backlit
[[ -s $unsaved ]] || fail "unsaved work was not kept"
start
picture offer
differs small_debug offer 50000
quit "the offer of unsaved work"
[[ -s $unsaved ]] || fail "unsaved work was lost"

# The arrangement is kept.
rm "$unsaved"
start
picture again
differs offer again 50000
quit "the second start"
grep -q 'debug' "$work"/data/backlit/*.ron || fail "the layout was not kept"

# A path that is not there is told at once, without a window.
if "$binary" "$work/no/such/take" >"$work/stdout" 2>"$work/stderr"; then
    fail "a path that is not there was opened"
fi
grep -q 'there is no such file or folder' "$work/stderr" || fail "a path that is not there was not named"
echo "ok: a path that is not there is named"

if [[ -n $take ]]; then
    start "$take"
    picture take
    differs nothing take 100000
    press Return take_run take 2000
    quit "$take"
fi
echo "ok: all"
