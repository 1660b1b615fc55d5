#!/usr/bin/env bash
# Runs NC text on the whole of LinuxCNC 2.9 without screen, in real time, and judges what its joints did.
#
#     tests/linuxcnc/controller.sh part.ngc certificate.json [REPORT_FOLDER]
#
# The text must be made for the machine linuxcnc-xyzac-trt; it runs as long as the part takes. Needs the package
# linuxcnc-uspace (apt-get install --no-install-recommends linuxcnc-uspace) and, as root, the user nobody: the controller
# refuses root. FLUTE is the length of the flutes, at whose end deviations are taken, TOOL_LENGTH the length of all tools
# in the tool table, mm. ABORT_LINE=N aborts the program in that line and starts it again instead of running it to its
# end.
set -euo pipefail
: "${FLUTE:?length of the flutes in mm}" "${TOOL_LENGTH:?length of the tools in mm}"
here=$(cd "$(dirname "$0")" && pwd)
nc=$(realpath "$1") certificate=$(realpath "$2")
command -v linuxcnc > /dev/null || { echo "linuxcnc is not installed" >&2; exit 3; }

room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
cp -r "$here"/{client.py,controller.ini,sampler.hal,remap} "$room"
cp "$nc" "$room/program.ngc"
# Lengths in mm: with an INI in mm the controller reads its table so.
grep -oE '^T[0-9]+' "$nc" | sort -u | while read -r t; do
    echo "$t P${t#T} Z$TOOL_LENGTH D2"
done > "$room/tool.tbl"
chmod 755 "$room"
# A busy machine would starve the servo thread, and motion commands would time out.
as=(env)
chrt -r 10 true 2> /dev/null && as=(chrt -r 10 env)
if [ "$(id -u)" = 0 ]; then
    chown -R nobody "$room"
    as=("${as[@]}" runuser -u nobody -- env)
fi
(cd "$room" && "${as[@]}" -u DISPLAY HOME="$room" ${ABORT_LINE:+ABORT_LINE=$ABORT_LINE} linuxcnc -r controller.ini) \
    > "$room/log" 2>&1 || { tail -n 30 "$room/log"; exit 1; }
if [ -n "${3:-}" ]; then
    mkdir -p "$3"
    cp "$room"/{log,samples.txt,events.json} "$3"
fi
python3 "$here/judge.py" "$room" "$nc" "$certificate"
