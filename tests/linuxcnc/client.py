#!/usr/bin/python3
"""Runs program.ngc on the controller that started this program: samples go to samples.txt, what happened to events.json.

With ABORT_LINE in the environment the program is aborted once that line runs, and started again from its beginning.
"""
import json, os, subprocess, sys, time
import linuxcnc

command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
events = []


def note(what, **more):
    status.poll()
    events.append({"what": what, "line": status.motion_line, **more})
    print(events[-1], flush=True)


def drain():
    while True:
        error = errors.poll()
        if not error:
            return
        kind = "error" if error[0] in (linuxcnc.NML_ERROR, linuxcnc.OPERATOR_ERROR) else "message"
        note(kind, text=error[1].strip())


def wait(done, patience):
    """Waits until `done` holds; false when an error came or patience ended before."""
    end = time.time() + patience
    while time.time() < end:
        status.poll()
        drain()
        if done():
            return True
        time.sleep(0.005)
    note("error", text=f"not done within {patience} s")
    return False


def idle():
    return status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and status.queue == 0


def start():
    command.mode(linuxcnc.MODE_AUTO)
    command.wait_complete()
    command.program_open(os.path.abspath("program.ngc"))
    command.wait_complete()
    note("start")
    command.auto(linuxcnc.AUTO_RUN, 0)
    time.sleep(0.5)


def main():
    time.sleep(0.5)
    status.poll()
    for state in (linuxcnc.STATE_ESTOP_RESET, linuxcnc.STATE_ON):
        command.state(state)
        command.wait_complete()
    command.mode(linuxcnc.MODE_MANUAL)
    command.wait_complete()
    command.home(-1)
    command.wait_complete()
    wait(lambda: all(status.homed[:5]), 20)
    command.mode(linuxcnc.MODE_MDI)
    command.wait_complete()
    command.teleop_enable(1)
    with open("samples.txt", "w") as out:
        sampler = subprocess.Popen(["halsampler", "-t"], stdout=out)
        try:
            patience = float(os.environ.get("PATIENCE", "3600"))
            abort = os.environ.get("ABORT_LINE")
            start()
            if abort:
                wait(lambda: status.motion_line >= int(abort) or idle(), patience)
                note("abort")
                command.abort()
                command.wait_complete()
                wait(idle, 20)
                time.sleep(0.5)
                note("aborted")
                start()
                patience = float(os.environ.get("AGAIN", "60"))
                end = time.time() + patience
                while time.time() < end and not idle():
                    time.sleep(0.05)
                    status.poll()
                    drain()
                command.abort()
                command.wait_complete()
            else:
                wait(idle, patience)
            note("end", joints=list(status.joint_position[:5]))
            time.sleep(0.3)
        finally:
            drain()
            sampler.terminate()
            sampler.wait()
    with open("events.json", "w") as out:
        json.dump(events, out, indent=1)


main()
