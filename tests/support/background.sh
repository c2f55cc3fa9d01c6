# background.sh - a program that runs while a script goes on, after harness.sh.

pid=
at_end() { [ -z "$pid" ] || kill -9 "$pid" 2>/dev/null; }
waited() # command...: until it succeeds, at most a minute
{
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ $tries -lt 600 ] || return 1
        sleep .1
    done
}
lines() { [ "$(grep -c -e "$2" log)" -ge "$1" ]; } # times regex: a line of "log" was written so often
start() # args...: in the background, with messages in "log"
{
    : >log
    "$L" "$@" >out 2>log </dev/null &
    pid=$!
}
stop() # signal: sets rc
{
    kill -"$1" $pid 2>/dev/null
    wait $pid
    # shellcheck disable=SC2034
    rc=$?
    pid=
    cp log err
}
