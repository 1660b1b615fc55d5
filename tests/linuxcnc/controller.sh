#!/usr/bin/env bash
# Runs NC text on the whole of LinuxCNC 2.9 without screen, in real time, and judges what its joints did.
#
#     tests/linuxcnc/controller.sh part.ngc certificate.json [REPORT_FOLDER]
#
# The text must be made for the machine linuxcnc-xyzac-trt or linuxcnc-xyzbc-trt, or for the one of `tall`, which has more
# travel of Z; it runs as long as the part takes. Needs the package linuxcnc-uspace (apt-get install --no-install-recommends linuxcnc-uspace) and,
# as root, the user nobody: the controller refuses root. FLUTE is the length of the flutes in mm, at whose end deviations
# are taken. The tool table has the lengths that the head of the text names. ABORT_LINE=N aborts the program in that line
# and starts it again instead of running it to its end.
set -euo pipefail
: "${FLUTE:?length of the flutes in mm}"
here=$(cd "$(dirname "$0")" && pwd)
nc=$(realpath "$1") certificate=$(realpath "$2")
command -v linuxcnc > /dev/null || { echo "linuxcnc is not installed" >&2; exit 3; }

room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
cp -r "$here"/{client.py,controller.ini,sampler.hal,remap} "$room"
cp "$nc" "$room/program.ngc"
# Lengths in mm: with an INI in mm the controller reads its table so.
sed -nE 's/^\(tool [^ ]+ number ([0-9]+): .* length ([0-9.]+) mm .*/T\1 P\1 Z\2 D2/p' "$nc" > "$room/tool.tbl"
read -r top tilt < <(python3 -c 'import json, sys
axes = json.load(open(sys.argv[1]))["measured"]["machine"]["axes"]
print(axes[2]["travel"][1], axes[3]["axis"])' "$certificate")
# Kinematics, offsets from the rotation point to the axis that tilts, and limits of [AXIS_A] or [AXIS_B].
case $tilt in
    A) set -- xyzac-trt "y-offset 20" "z-offset 10" -100 50 "${@:3}" ;;
    B) set -- xyzbc-trt "x-offset -20" "z-offset -15" -36000 36000 "${@:3}" ;;
    *) echo "no configuration of LinuxCNC tilts $tilt" >&2; exit 3 ;;
esac
sed -i "s/^MAX_LIMIT = 120\$/MAX_LIMIT = $top/; s/@TILT@/$tilt/; s/@KINEMATICS@/$1/; s/@ACROSS@/$2/; s/@UP@/$3/; s/@LEAST@/$4/; s/@MOST@/$5/" \
    "$room/controller.ini"
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
if [ -n "${6:-}" ]; then
    mkdir -p "$6"
    cp "$room"/{log,samples.txt,events.json} "$6"
fi
python3 "$here/judge.py" "$room" "$nc" "$certificate"
