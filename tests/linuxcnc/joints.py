#!/usr/bin/python3
"""A kinematics module of LinuxCNC, xyzac-trt or xyzbc-trt: poses on standard input (x y z, the table that tilts, c; mm and
degrees). Out come its joints, and the axis of the tool in the frame of the pose: where the pose goes when the joint of Z
rises by 1 mm. The joints forward again must give the pose.

    joints.py MODULE.so HAL.so PIN=VALUE...
"""
import ctypes, os, sys

module, hal = sys.argv[1:3]
name = os.path.basename(module).removesuffix(".so")
letters = {"xyzac-trt-kins": "xyzac", "xyzbc-trt-kins": "xyzbc"}[name]
hal = ctypes.CDLL(hal, mode=ctypes.RTLD_GLOBAL)
hal.set_pin.argtypes = [ctypes.c_char_p, ctypes.c_double]
kinematics = ctypes.CDLL(module)
assert kinematics.rtapi_app_main() == 0
for pin in sys.argv[3:]:
    pin, value = pin.split("=")
    assert hal.set_pin(f"{name}.{pin}".encode(), float(value)) == 0, pin


class Pose(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in "xyzabcuvw"]


flags = [ctypes.byref(ctypes.c_ulong(0)) for _ in range(2)]


def forward(joints):
    pose = Pose()
    assert kinematics.kinematicsForward(joints, ctypes.byref(pose), *flags) == 0
    return [getattr(pose, letter) for letter in letters]


for line in sys.stdin:
    words = list(map(float, line.split()))
    joints = (ctypes.c_double * 16)()
    pose = Pose(**dict(zip(letters, words)))
    assert kinematics.kinematicsInverse(ctypes.byref(pose), joints, *flags) == 0
    back = forward(joints)
    off = max(abs(b - w) for b, w in zip(back, words))
    assert off < 1e-9, (line, off)
    found = list(joints[:5])
    joints[2] += 1.0
    print(*map(repr, found), *(repr(r - b) for r, b in zip(forward(joints)[:3], back)))
