# SPDX-License-Identifier: Apache-2.0
"""Contract C5 where time is short: a node that is killed or stands still is told within seconds, by name, frame and
region. These tests want the machine for themselves."""

import os
import re
import signal
import time

from harness import BUILD, Folder, main, node_process, processes_in
from scenes_for_faults import SLOW_70


def kill_in_mid_frame(program, expected, index):
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW_70)
        process = folder.start("render", scene, "-r", 3, "-s", 3, "--frames", 200, "--chord", 1, "-o",
                               folder.file("slow.%04d.exr"))
        first = folder.file("slow.0070.exr")
        deadline = time.time() + 60
        while not os.path.exists(first) and time.time() < deadline and process.poll() is None:
            time.sleep(0.01)
        assert os.path.exists(first), "no first frame: %s" % (process.communicate()[1],)
        time.sleep(0.15)
        pid = node_process(folder, program, index)
        assert pid, "no such process: %s" % processes_in(folder.path)
        begin = time.time()
        os.kill(pid, signal.SIGKILL)
        err = ""
        while "sortlast:" not in err:  # progress lines may come first
            line = process.stderr.readline()
            assert line, "no message: %s" % err
            err += line
        took = time.time() - begin
        err += process.communicate(timeout=20)[1]
        assert process.returncode not in (0, None), "exit status %s" % process.returncode
        errors = [line for line in err.splitlines() if line.startswith("sortlast:")]
        assert len(errors) == 1 and expected in errors[0] and re.search(r"in frame 7\d, region \d+", errors[0]), err
        assert took < 2 + (4 if "sanitize" in BUILD else 0), "took %.1f s" % took
        folder.assert_nothing_left()
        names = [n for n in os.listdir(folder.path) if n not in ("tmp", "slow.rib")]
        assert names and all(n.startswith("slow.") and n.endswith(".exr") for n in names), "left: %s" % names
        for name in names:  # what is there is whole
            code, out, err = folder.run("compare", folder.file(name), folder.file(name))
            assert code == 0, "%s: %s%s" % (name, out, err)


def test_killing_the_host():
    kill_in_mid_frame("sortlast-host", "host", 0)


def test_killing_a_rendering_node():
    kill_in_mid_frame("sortlast-rendering-node", "rendering node 1", 1)


def test_killing_a_shading_node():
    kill_in_mid_frame("sortlast-shading-node", "shading node 2", 2)


def test_killing_the_framebuffer_node():
    kill_in_mid_frame("sortlast-framebuffer-node", "framebuffer node", 0)


def test_a_stuck_node_ends_the_run_at_the_deadline_and_all_say_what_they_wait_for():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW_70)
        process = folder.start("render", scene, "-r", 2, "-s", 2, "--frames", 2000, "--deadline", 6, "--chord", 2)
        err = ""
        while "frame 71:" not in err:
            line = process.stderr.readline()
            assert line, err
            err += line
        os.kill(node_process(folder, "sortlast-shading-node", 1), signal.SIGSTOP)
        err += process.communicate(timeout=40)[1]
        assert process.returncode == 2 and "nothing happened for 6 s" in err, err
        for node in ("host", "rendering node 0", "rendering node 1", "shading node 0", "framebuffer node"):
            assert re.search("sortlast: %s (waits|works)" % node, err), "%s says nothing:\n%s" % (node, err)
        assert re.search(r"framebuffer node waits for region \d+ of frame 7\d from shading node 1", err), err
        folder.assert_nothing_left()


if __name__ == "__main__":
    main(globals())
