# SPDX-License-Identifier: Apache-2.0
"""Contract C5: whatever goes wrong ends in seconds, with one clear message, a non-zero exit status, and nothing left
behind; finished frames stay. Nodes that are killed or stand still: test_killed_nodes.py."""

import os
import re
import resource
import signal
import socket
import subprocess
import tempfile
import time

from harness import BUILD, SORTLAST, Folder, main, processes_in
from scenes_for_faults import QUICK, SLOW


def test_killing_the_supervisor_leaves_nothing():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW)
        process = folder.start("render", scene, "-r", 2, "-s", 2, "--frames", 200)
        deadline = time.time() + 30
        while len(processes_in(folder.path)) < 6 and time.time() < deadline:
            time.sleep(0.02)
        time.sleep(1)
        process.kill()
        process.communicate()
        folder.assert_nothing_left()


def test_killing_the_supervisor_while_it_starts_leaves_nothing():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW)
        for transport in ("ipc", "tcp"):
            for wait in (0.03, 0.06, 0.1, 0.15, 0.2, 0.3):
                process = folder.start("render", scene, "-r", 3, "-s", 2, "--transport", transport)
                deadline = time.time() + 10
                while len(processes_in(folder.path)) < 2 and time.time() < deadline:
                    pass
                time.sleep(wait)
                process.kill()
                process.communicate()
                folder.assert_nothing_left()


def test_interrupt_ends_everything():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW)
        process = folder.start("render", scene, "-r", 2, "-s", 2, "--frames", 200)
        time.sleep(1.5)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=10)
        assert process.returncode == 128 + signal.SIGINT
        folder.assert_nothing_left()


def fails(folder, arguments, *words, status=None, seconds=10):
    begin = time.time()
    code, out, err = folder.run(*arguments, timeout=60)
    took = time.time() - begin
    assert code != 0, "succeeded: %s" % (arguments,)
    assert status is None or code == status, "exit status %d: %s" % (code, err)
    for word in words:
        assert word in err, "%r is not in:\n%s" % (word, err)
    assert sum(line.startswith("sortlast:") for line in err.splitlines()) == 1, err
    assert took < seconds, "took %.1f s" % took
    folder.assert_nothing_left()
    return err


DRIVERS = (["--driver", "in-process"], ["--driver", "processes", "-r", "2", "-s", "2"])


def test_wrong_scenes_and_shaders_are_named_by_place():
    bad = {
        "missing.rib": (None, ["missing.rib", "No such file"]),
        "syntax.rib": ("WorldBegin\nSphere 1 -1 [\nWorldEnd\n", ["syntax.rib:"]),
        "noworld.rib": ("Format 10 10 1\n", ["noworld.rib", "WorldBegin"]),
        "noshader.rib": ('WorldBegin\n  Surface "nosuch"\nSphere 1 -1 1 360\nWorldEnd\n',
                         ["noshader.rib:2:", "nosuch"]),
        "parameter.rib": ('WorldBegin\nSurface "matte" "uniform float Kx" [1]\nSphere 1 -1 1 360\nWorldEnd\n',
                          ["parameter.rib:2:", "Kx", "Kd"]),
        "type.rib": ('WorldBegin\nSurface "matte" "uniform color Kd" [1 1 1]\nSphere 1 -1 1 360\nWorldEnd\n',
                     ["type.rib:2:", "Kd", "color"]),
        "light.rib": ('WorldBegin\nLightSource "matte" 1\nSurface "matte"\nSphere 1 -1 1 360\nWorldEnd\n',
                      ["light.rib:2:", "surface"]),
        "broken.rib": ('WorldBegin\nSurface "broken"\nSphere 1 -1 1 360\nWorldEnd\n', ["broken.sl:2:", "error"]),
        "types.rib": ('WorldBegin\nSurface "types"\nSphere 1 -1 1 360\nWorldEnd\n', ["types.sl:2:", "error"]),
    }
    with Folder() as folder:
        folder.write("broken.sl", "surface broken() {\n    Ci = (1 + ;\n}\n")
        folder.write("types.sl", "surface types() {\n    uniform float x = s;\n    Ci = x;\n}\n")
        for name, (text, words) in bad.items():
            if text is not None:
                folder.write(name, text)
            for driver in DRIVERS:
                fails(folder, ["render", folder.file(name), "-o", folder.file("x.exr"), *driver], *words, status=1)
                assert not os.path.exists(folder.file("x.exr"))


def test_wrong_options_are_refused():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        for option, value in (("-r", "0"), ("-s", "0"), ("-r", "-3"), ("-r", "1000000000"), ("-s", "x"), ("--format", "0x10"),
                              ("--format", "10"), ("--samples", "3"), ("--samples", "4x0"), ("--format", "65537x1"),
                              ("-s", "2000"), ("--frames", "0"), ("--driver", "magic"),
                              ("--machine", "/nonexistent.json"), ("--transport", "pigeon"), ("--compression", "lots")):
            fails(folder, ["render", scene, option, value], "sortlast:", status=1, seconds=3)
        fails(folder, ["render", scene, "--format", "65536x65536", "-o", folder.file("x.exr")], "over the limit", status=1,
              seconds=3)
        fails(folder, ["render"], "no scene", status=1)
        fails(folder, ["render", "--nonsense", scene], "nonsense", status=1)


def test_a_wrong_machine_is_named():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        for text, words in (("{", ["m.json:1:"]), ('{"name": "x", "parameters": {}}', ["m.json", "missing"]),
                            ('{"name": "x", "parameters": {"warp_factor": {"value": 9}}}', ["warp_factor"])):
            fails(folder, ["render", scene, "--machine", folder.write("m.json", text)], *words, status=1)


def test_outputs_that_cannot_be_written():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        os.mkdir(folder.file("folder.exr"))
        for driver in DRIVERS:
            for option, name in (("-o", "no/such/folder/x.exr"), ("--json", "no/such.json"), ("-o", "folder.exr")):
                err = fails(folder, ["render", scene, option, folder.file(name), *driver], name)
                assert "frame 1" not in err, "noticed only after rendering: %s" % err
        fails(folder, ["render", scene, "-o", folder.file("x.png")], "must end in .exr", "--png", status=1)


def limit_files():
    """What a full disk is like, for a process about to start."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


def test_the_reason_of_a_failing_node_is_told_even_while_the_host_is_sending():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW)
        folder.render(scene, "--format", "64x48", "--chord", "1")  # shaders are compiled now
        process = folder.start("render", scene, "-r", 2, "-s", 2, "--frames", 40, "--format", "64x48", "--chord", "1", "-o",
                               folder.file("x.exr"), "--compression", "none", preexec_fn=limit_files)
        err = process.communicate(timeout=60)[1]
        assert process.returncode == 2 and "framebuffer node: cannot write '%s" % folder.file("x") in err, err
        assert sum(line.startswith("sortlast:") for line in err.splitlines()) == 1, err
        folder.assert_nothing_left()


def test_interrupt_ends_the_in_process_driver():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW)
        process = folder.start("render", scene, "--driver", "in-process", "--frames", 2000, "--chord", 2)
        time.sleep(1.5)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=20)
        assert process.returncode == 128 + signal.SIGTERM


def test_an_interrupt_while_shaders_compile_leaves_no_compiler_and_no_file():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        compiler = folder.write("slowcc", "#!/bin/sh\nsleep 20\nexec cc \"$@\"\n")
        os.chmod(compiler, 0o700)
        environment = folder.environment(SORTLAST_CC=compiler, SORTLAST_CACHE=folder.file("cache"))
        process = subprocess.Popen([SORTLAST, "render", scene], cwd=folder.path, env=environment, stderr=subprocess.PIPE)
        time.sleep(1.5)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
        assert process.returncode == 128 + signal.SIGINT
        folder.assert_nothing_left()
        left = [name for name in os.listdir(folder.file("cache")) if not name.startswith("runtime-")]
        assert not left, left


def test_an_interrupt_or_a_lost_supervisor_while_shaders_compile_leaves_no_file_of_the_compiler():
    with Folder() as folder:
        scene = folder.write("slow.rib", SLOW)
        for number, wait in ((signal.SIGINT, 0.3), (signal.SIGKILL, 0.3), (signal.SIGKILL, 0.6), (signal.SIGTERM, 0.6)):
            environment = folder.environment(SORTLAST_CACHE=tempfile.mkdtemp(dir=folder.path))
            process = subprocess.Popen([SORTLAST, "render", scene], cwd=folder.path, env=environment, stderr=subprocess.PIPE)
            time.sleep(wait)
            process.send_signal(number)
            err = process.communicate(timeout=20)[1]
            folder.assert_nothing_left()
            assert b"compiler" not in err, "an interrupt is reported as a failure: %s" % err


def test_two_variants_of_a_shader_in_an_empty_cache():
    with Folder() as folder:
        polygon = 'Polygon "P" [-1 -1 2  1 -1 2  1 1 2] %s\n'
        scene = folder.write("two.rib", 'Format 64 48 1\nWorldBegin\nSurface "matte"\n' + polygon % "" +
                             polygon % '"varying float foo" [0 0 1]' + "WorldEnd\n")
        for driver in DRIVERS:
            cache = folder.file("cache" + driver[1])
            result = subprocess.run([SORTLAST, "render", scene, "-q", *driver], cwd=folder.path, capture_output=True, text=True,
                                    env=folder.environment(SORTLAST_CACHE=cache), timeout=60)
            assert result.returncode == 0, result.stderr


def test_frames_of_one_number_do_not_overwrite_each_other():
    with Folder() as folder:
        world = 'WorldBegin\nSurface "constant"\nSphere 1 -1 1 360\nWorldEnd\n'
        scene = folder.write("same.rib", "Format 64 48 1\n" + 3 * world)
        summary = folder.render(scene, "--driver", "in-process", "-o", folder.file("a.exr"))
        names = [frame["image"] for frame in summary["frames"]]
        assert len(set(names)) == 3 and all(os.path.exists(name) for name in names), names


def test_an_empty_frame_after_a_heavy_one_takes_no_negative_time():
    with Folder() as folder:
        heavy = 'FrameBegin 1\nWorldBegin\nSurface "marble"\nLightSource "distant" 1\nTranslate 0 0 3\nSphere 1 -1 1 360\nWorldEnd\nFrameEnd\n'
        scene = folder.write("two.rib", 'Format 640 480 1\n' + heavy + "FrameBegin 2\nWorldBegin\nWorldEnd\nFrameEnd\n")
        frames = folder.render(scene, "--driver", "in-process")["frames"]
        assert 0 <= frames[1]["time_ps"] == frames[1]["end_ps"] - frames[0]["end_ps"] < frames[0]["time_ps"], frames


def test_closed_standard_streams_do_not_confuse():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        result = subprocess.run('"%s" render "%s" -o q.exr -q <&- >&- 2>&-' % (SORTLAST, scene), shell=True, cwd=folder.path,
                                env=folder.environment(), timeout=60)
        assert result.returncode == 0
        folder.render(scene, "-o", folder.file("r.exr"))
        folder.assert_same_picture(folder.file("q.exr"), folder.file("r.exr"))


def test_a_full_disk_leaves_no_partial_picture():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        folder.render(scene)  # shaders are compiled now
        for driver in DRIVERS:
            process = folder.start("render", scene, "-o", folder.file("x.exr"), "--compression", "none", *driver,
                                   preexec_fn=limit_files)
            out, err = process.communicate(timeout=60)
            assert process.returncode != 0 and "x.exr" in err, err
            assert not [n for n in os.listdir(folder.path) if ".exr" in n], os.listdir(folder.path)
            folder.assert_nothing_left()


def test_a_port_in_use_is_named():
    with Folder() as folder, socket.socket() as taken:
        scene = folder.write("quick.rib", QUICK)
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = "tcp://127.0.0.1:%d" % taken.getsockname()[1]
        result = subprocess.run([SORTLAST + "-host", "--bind", endpoint, scene], capture_output=True, text=True, timeout=20)
        assert result.returncode == 2 and endpoint in result.stderr and "in use" in result.stderr, result.stderr


def test_a_missing_node_is_waited_for_with_a_deadline_and_named():
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        endpoint = "ipc://" + folder.file("tmp/host")
        host = subprocess.Popen([SORTLAST + "-host", "--bind", endpoint, "-r", "1", "-s", "1", "--deadline", "6", scene], cwd=folder.path,
                                stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        node = subprocess.Popen([SORTLAST + "-rendering-node", "--host", endpoint], cwd=folder.path,
                                stderr=subprocess.PIPE, text=True)
        time.sleep(1)
        host.send_signal(signal.SIGUSR1)
        node.send_signal(signal.SIGUSR1)
        out, err = host.communicate(timeout=40)
        node_err = node.communicate(timeout=10)[1]
        assert host.returncode == 2 and "shading node 0" in err and "nothing happened" in err, err
        assert err.count("waits for 2 of 3 nodes to join") == 2, err  # on SIGUSR1 and at the end
        assert "waits for the host" in node_err and node.returncode == 3, node_err
        folder.assert_nothing_left()


def test_cluster_local_runs_a_cluster_and_cleans_up():
    script = os.path.join(os.path.dirname(__file__), "..", "..", "scripts", "cluster-local")
    with Folder() as folder:
        scene = folder.write("quick.rib", QUICK)
        environment = folder.environment(SORTLAST_PROGRAMS=BUILD)
        for name, code in (("quick.rib", 0), ("missing.rib", 1)):
            result = subprocess.run([script, "2", "2", "-q", "-o", folder.file("q.exr"), folder.file(name)], env=environment,
                                    cwd=folder.path, capture_output=True, text=True, timeout=60)
            assert result.returncode == code, (result.returncode, result.stderr)
            folder.assert_nothing_left()
        folder.render(scene, "-o", folder.file("r.exr"))
        folder.assert_same_picture(folder.file("q.exr"), folder.file("r.exr"))


if __name__ == "__main__":
    main(globals())
