#!/usr/bin/python3
"""The kinematics module xyzac-trt of LinuxCNC: poses on standard input (x y z a c, mm and degrees), its joints out; the same
pose forward again must give the pose.

    joints.py MODULE.so HAL.so PIN=VALUE...
"""
import ctypes, sys

module, hal = sys.argv[1:3]
hal = ctypes.CDLL(hal, mode=ctypes.RTLD_GLOBAL)
hal.set_pin.argtypes = [ctypes.c_char_p, ctypes.c_double]
kinematics = ctypes.CDLL(module)
assert kinematics.rtapi_app_main() == 0
for pin in sys.argv[3:]:
    name, value = pin.split("=")
    assert hal.set_pin(f"xyzac-trt-kins.{name}".encode(), float(value)) == 0, pin


class Pose(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in "xyzabcuvw"]


flags = [ctypes.byref(ctypes.c_ulong(0)) for _ in range(2)]
for line in sys.stdin:
    x, y, z, a, c = map(float, line.split())
    joints = (ctypes.c_double * 16)()
    pose, back = Pose(x=x, y=y, z=z, a=a, c=c), Pose()
    assert kinematics.kinematicsInverse(ctypes.byref(pose), joints, *flags) == 0
    assert kinematics.kinematicsForward(joints, ctypes.byref(back), *flags) == 0
    off = max(abs(getattr(back, k) - getattr(pose, k)) for k in "xyzac")
    assert off < 1e-9, (line, off)
    print(*(repr(j) for j in joints[:5]))
