#!/bin/sh
# page.sh - the page of `lightcuts report` in headless Chromium: no errors, nothing loaded, the slider moves,
# every number is that of report.json; on a desk, and on a dark phone.
#
#     sh tests/page.sh build/lightcuts
#
# The tests of the page are in page.js, which goes into a copy of the page together with report.json. Without
# Chromium only what needs no browser is tested.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/page.sh BINARY" >&2; exit 2; }
begin "$1"

"$L" scene cornell --lights 600 >cornell.pbrt
"$L" scene grid --lights 400 >'odd <name> & "more".pbrt'
timeout 300 "$L" report --quick -q cornell.pbrt odd*.pbrt -o r --error-ratios 0.5,0.1,0.02 --max-cut 100 2>err
status=$?
if [ $status -eq 0 ]; then ok; else no report "status $status"; fi
check 'what is written' test "$(ls r | tr '\n' ' ')" = 'index.html renders report.json '
one_file() # the page names no other
{
    [ -s r/index.html ] &&
        ! grep -q -e 'src="[^d]' -e 'href="[^#d]' -e '<link rel="style' -e '@import' -e 'url(' r/index.html
}
check 'the page names no other file' one_file

copy() # out: the page with the test in it
{
    awk -v out="$1" -v json=r/report.json -v js="$here/page.js" '
        function put(file, line) { while ((getline line < file) > 0) print line > out; close(file) }
        /^<head>$/ {
            print "<head><script>window.pageErrors = [];" > out
            print "for (const kind of [\"error\", \"unhandledrejection\", \"securitypolicyviolation\"])" > out
            print "  addEventListener(kind, (e) =>" > out
            print "    pageErrors.push(kind + \" \" + (e.message || e.reason || e.violatedDirective))," > out
            print "    true);" > out
            print "console.error = console.warn =" > out
            print "  (...text) => pageErrors.push(text.join(\" \"));</script>" > out
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
    timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage \
        --user-data-dir="$T/profile" --enable-logging=stderr --virtual-time-budget=10000 "$@" \
        --dump-dom "file://$T/$file" >dom 2>log
    sed -n '/<pre id="selftest">/,/^end/p' dom >lines
    grep -q '^end' lines || no "$name" "the page's test did not end: $(grep -v dbus log | tail -n 3)"
    n=$(grep -c '^ok ' lines)
    passed=$((passed + n))
    grep '^FAIL ' lines >bad && while read -r line; do no "$name" "$line"; done <bad
    if grep -q CONSOLE log; then no "$name" "$(grep CONSOLE log | head -n 3)"; else ok; fi
}
if ! has chromium; then
    skip 'the page on a desk' 'no chromium'
    skip 'the page on a dark phone' 'no chromium'
elif [ -s r/index.html ]; then
    copy copy.html
    # No window is as narrow as a phone: the page is in a frame, from which it sends its lines.
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
fi

finish
