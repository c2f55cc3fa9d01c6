#!/bin/sh
# page.sh - the page of `lightcuts report` in headless Chromium: no errors, nothing loaded, the slider moves, every number is
# that of report.json; on a desk, and on a dark phone.
#
#     sh tests/page.sh build/lightcuts
#
# The tests themselves are in page.js, which goes into a copy of the page together with report.json. Without Chromium only
# what needs no browser is tested. Ends with "N passed, N failed".
set -u
[ $# -eq 1 ] && [ -x "$1" ] || { echo "usage: sh tests/page.sh BINARY" >&2; exit 2; }
L=$(cd "$(dirname "$1")" && pwd)/${1##*/}
here=$(cd "$(dirname "$0")" && pwd)
T=$(mktemp -d) || exit 2
trap 'rm -rf "$T"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
cd "$T" || exit 2
unset LC_ISA
passed=0
failed=0
ok() { passed=$((passed + 1)); }
no() # name why
{
    failed=$((failed + 1))
    echo "FAIL $1: $2"
}

"$L" scene cornell --lights 600 >cornell.pbrt
"$L" scene grid --lights 400 >'odd <name> & "more".pbrt'
if timeout 300 "$L" report --quick -q cornell.pbrt odd*.pbrt -o r --error-ratios 0.5,0.1,0.02 --max-cut 100 2>err; then ok; else
    no report "status $?: $(cat err)"
fi
[ "$(ls r)" = "index.html
renders
report.json" ] && ok || no 'what is written' "$(ls r | tr '\n' ' ')"
grep -q -e 'src="[^d]' -e 'href="[^#d]' -e '<link rel="style' -e '@import' -e 'url(' r/index.html && no 'one file' 'it names another' || ok

copy() # out: the page with the test in it
{
    awk -v out="$1" -v json=r/report.json -v js="$here/page.js" '
        function put(file, line) { while ((getline line < file) > 0) print line > out; close(file) }
        /^<head>$/ {
            print "<head><script>window.pageErrors = [];" > out
            print "for (const kind of [\"error\", \"unhandledrejection\", \"securitypolicyviolation\"])" > out
            print "  addEventListener(kind, (e) =>" > out
            print "    pageErrors.push(kind + \" \" + (e.message || e.reason || e.violatedDirective)), true);" > out
            print "console.error = console.warn = (...text) => pageErrors.push(text.join(\" \"));</script>" > out
            next
        }
        /^<\/body>$/ {
            printf "<script type=\"application/json\" id=\"beside\">" > out
            put(json)
            print "</script><script>" > out
            put(js)
            print "</script>" > out
        }
        { print > out }' r/index.html
}

browse() # name file options...
{
    name=$1 file=$2
    shift 2
    timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir="$T/profile" \
        --enable-logging=stderr --virtual-time-budget=10000 "$@" --dump-dom "file://$T/$file" >dom 2>log
    sed -n '/<pre id="selftest">/,/^end/p' dom >lines
    grep -q '^end' lines || no "$name" "the page's test did not end: $(grep -v dbus log | tail -n 3)"
    n=$(grep -c '^ok ' lines)
    passed=$((passed + n))
    grep '^FAIL ' lines >bad && while read -r line; do no "$name" "$line"; done <bad
    if grep -q CONSOLE log; then no "$name" "$(grep CONSOLE log | head -n 3)"; else ok; fi
}
if command -v chromium >/dev/null 2>&1 && [ -s r/index.html ]; then
    copy copy.html
    # No window is as narrow as a phone, so the page is in a frame, which may not be looked into and sends its lines.
    cat >phone.html <<'END'
<!DOCTYPE html><html style="color-scheme: light dark"><body>
<script>addEventListener('message', (e) => {
  const pre = document.createElement('pre');
  pre.id = 'selftest';
  pre.textContent = e.data;
  document.body.append(pre);
});</script>
<iframe src="copy.html?dark" style="width: 390px; height: 844px; border: 0"></iframe></body></html>
END
    browse 'desk' copy.html --window-size=1280,900
    browse 'dark phone' phone.html --window-size=600,900 --blink-settings=preferredColorScheme=0
else
    echo "skip the page in a browser: no chromium here"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
