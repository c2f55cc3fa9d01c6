#!/bin/sh
# load.sh - many renders at once, at the edges of what the machine gives them.
#
#     sh tests/load.sh build/lightcuts [SECONDS [SEED]]     rounds until SECONDS have passed, default one round
#
# A round is 200 renders at once, some of which are stopped and continued at random, in each of these ways:
# without limits; with few descriptors or little memory; as a user that may have few threads; on a disk of
# 3 MiB that something else fills and empties; with clocks that jump (BIN/tests/lightcuts_clock). Each must
# end with status 0 and the bytes of the undisturbed picture, or with a status that says so, a message and no
# picture; a checkpoint that it leaves leads to that picture (20 of each way are tried, with SECONDS all).
# Without limits all must be right. Nothing else is left over: no temporary file, no process.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -ge 1 ] || { echo "usage: sh tests/load.sh BINARY [SECONDS [SEED]]" >&2; exit 2; }
clock=$(cd "$(dirname "$1")" && pwd)/tests/lightcuts_clock
seconds=${2:-0} state=${3:-4711}
at_end()
{
    rm -f "$T/running"
    [ ! -s "$T/pids" ] || kill -KILL $(cat "$T/pids") 2>/dev/null
    umount "$T/disk" 2>/dev/null
}
begin "$1"
export SOURCE_DATE_EPOCH=0
renders=200
sanitized && renders=40
name=load-$$ # of the processes
cp "$L" "$name"
L=$T/$name # which no build replaces
[ ! -x "$clock" ] || { mkdir clock && cp "$clock" "clock/$name"; }
chmod 755 . "$name"

random() # n: sets $r to 0 .. n - 1
{
    state=$(((state * 1103515245 + 12345) % 2147483648))
    r=$((state / 65536 % $1))
}

{
    cat <<'END'
LookAt 0 0 -5  0 0 0  0 1 0
Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" 48 "integer yresolution" 32
Sampler "independent" "integer pixelsamples" 1
Integrator "directlighting"
WorldBegin
Material "diffuse"
Shape "trianglemesh" "point3 P" [-4 -4 0  4 -4 0  4 4 0  -4 4 0] "integer indices" [0 1 2 0 2 3]
Shape "sphere"
END
    awk 'BEGIN { for (i = 0; i < 120; i++) printf "LightSource \"point\" \"point3 from\" [%g %g %g] \"rgb I\" [%g 1 .5]\n",
        i * 37 % 101 * .04 - 2, i * 53 % 97 * .04 - 2, -1.5 - i * 29 % 89 * .02, .1 * (i % 17) }'
} >scene.pbrt
"$L" -q scene.pbrt -t 1 -o want.exr 2>err || no 'the undisturbed render' "status $?"

# ---- one round ----

# Stops and continues processes of the file `pids` while there is the file `running`, with pauses of 10 ms.
stopper()
{
    while [ -f running ]; do
        n=$(wc -l <pids)
        random $((n + 1))
        pid=$(sed -n "${r}p" pids)
        sleep 0.01
        [ -n "$pid" ] && kill -STOP "$pid" 2>/dev/null || continue
        sleep 0.01
        kill -CONT "$pid" 2>/dev/null
    done
}

# Starts render i, by the function `limited`, in a process of its own; its status goes to the file rc.
start() # i folder
{
    mkdir -p "$2/$1"
    set -- "$1" "$2/$1" -q scene.pbrt -t 3 -o "$2/$1/o.exr"
    [ $(($1 % 2)) -eq 0 ] || set -- "$@" --checkpoint "$2/c.ckpt" --checkpoint-interval 1s
    (
        i=$1 dir=$2
        shift 2
        limited "$@" >"log/$i.out" 2>"log/$i.err" </dev/null
    ) &
    echo $! >>pids
}
judge() # way i dir status
{
    if [ "$4" -eq 0 ]; then
        cmp -s want.exr "$3/o.exr" || { no "$1" "render $2: another picture"; return 1; }
    elif [ "$4" -gt 128 ]; then
        cp "log/$2.err" err
        no "$1" "render $2: status $4"
        return 1
    elif [ -e "$3/o.exr" ] || [ ! -s "log/$2.err" ]; then
        no "$1" "render $2: status $4 with a picture or without a message"
        return 1
    else
        refused=$((refused + 1))
    fi
    [ ! -e "$3/c.ckpt" ] && return
    [ "$4" -ne 0 ] || { no "$1" "render $2: its checkpoint is left over"; return 1; }
    [ $seconds -gt 0 ] || [ $((again += 1)) -le 20 ] || return 0
    cp "$3/c.ckpt" again.ckpt # from a disk that may be full
    "$L" -q scene.pbrt -o again.exr --checkpoint again.ckpt --resume 2>err && cmp -s want.exr again.exr ||
        { no "$1" "render $2: going on with its checkpoint"; return 1; }
}
# All renders at once, by `limited`; sets $refused.
crowd() # way folder
{
    rm -rf log pids "$2"/[0-9]*
    mkdir -p log "$2"
    : >pids
    : >running
    i=0 refused=0 again=0 good=1
    while [ $i -lt $renders ]; do
        start $i "$2"
        i=$((i + 1))
    done
    stopper &
    stopper=$!
    i=0
    for pid in $(cat pids); do
        wait "$pid"
        echo $? >"log/$i.rc"
        i=$((i + 1))
    done
    rm -f running
    wait $stopper
    kill_filler
    i=0
    while [ $i -lt $renders ] && [ $good -eq 1 ]; do
        judge "$1" $i "$2/$i" "$(cat log/$i.rc)" || good=0
        i=$((i + 1))
    done
    : >pids
    left=$(find "$2" -name '*.tmp' | head -n 1)
    [ -z "$left" ] || { no "$1" "left over: $left"; good=0; }
    left=$(cat /proc/[0-9]*/stat 2>/dev/null | grep "($name)") # a zombie, too
    [ -z "$left" ] || { no "$1" "a process is left: $left"; good=0; }
    [ $good -eq 0 ] || ok
    [ $good -eq 0 ] || echo "$1: $((renders - refused)) of $renders pictures, $refused refused"
}
filler=
kill_filler()
{
    [ -n "$filler" ] || return 0
    kill "$filler" 2>/dev/null
    wait "$filler" 2>/dev/null
    filler=
}

# ---- the ways ----

without_limits()
{
    limited() { exec "$T/$name" "$@"; }
    crowd 'without limits' many
    [ "$refused" -eq 0 ] || no 'without limits' "$refused were refused"
}
few_descriptors_or_little_memory() # from too little to begin with to enough; below `room` there is no program
{
    room=4000
    sanitized || until (ulimit -v $room; exec "$T/$name" --version) >/dev/null 2>&1; do room=$((room + 100)); done
    limited()
    {
        if [ $((i / 2 % 2)) -eq 0 ] || sanitized; then ulimit -n $((3 + i / 4 % 8)) # sanitizers map terabytes
        else ulimit -v $((room + i * 250))
        fi
        exec "$T/$name" "$@"
    }
    crowd 'few descriptors or little memory' many
}
few_threads() # a user of its own, which others' processes don't count for; it writes to folders that anyone may
{
    limited()
    {
        chmod 777 "$dir"
        exec setpriv --reuid 54321 --regid 54321 --clear-groups prlimit --nproc=$((2 + 3 * i)) "$T/$name" "$@"
    }
    crowd 'few threads' many
}
full_disk()
{
    mkdir -p disk
    mount -t tmpfs -o size=3m none disk 2>/dev/null || { skip 'a full disk' 'no right to mount one'; return; }
    while :; do
        head -c 4000000 /dev/zero >disk/filler 2>/dev/null
        sleep 0.05
        rm -f disk/filler
        sleep 0.05
    done &
    filler=$!
    limited() { exec "$T/$name" "$@"; }
    crowd 'a full disk' disk
    umount disk
}
jumping_clocks()
{
    limited()
    {
        [ $((i % 2)) -eq 0 ] || set -- "$@" --time-limit 500h # which is over after some jumps
        CLOCK_SEED=$((state + i)) exec "$T/clock/$name" "$@"
    }
    crowd 'jumping clocks' many
}

begun=$(date +%s)
while :; do
    without_limits
    few_descriptors_or_little_memory
    if sanitized; then skip 'few threads' 'the sanitizer starts threads of its own'
    elif [ "$(id -u)" -ne 0 ] || ! has setpriv || ! has prlimit; then skip 'few threads' 'no right to be another user'
    elif ! setpriv --reuid 54321 --regid 54321 --clear-groups "$T/$name" --version >/dev/null 2>&1; then
        skip 'few threads' 'another user cannot run the program here'
    else few_threads
    fi
    full_disk
    if [ -d clock ]; then jumping_clocks; else skip 'jumping clocks' "no $clock"; fi
    [ "$failed" -eq 0 ] && [ $(($(date +%s) - begun)) -lt "$seconds" ] || break
done
finish
