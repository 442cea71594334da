# SPDX-License-Identifier: Apache-2.0
"""What the tests of whole clusters share: running the command, reading its JSON, looking for leftovers.

Each test file is a program: it runs every function whose name begins with `test_`, prints one line for each, and
exits non-zero when one failed. The build folder comes from SORTLAST_BUILD."""

import json
import os
import struct
import subprocess
import sys
import tempfile
import time
import traceback

BUILD = os.path.abspath(os.environ.get("SORTLAST_BUILD", "build"))
SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
SORTLAST = os.path.join(BUILD, "sortlast")
SCENES = os.path.join(SOURCE, "scenes")
SANITIZED = os.environ.get("SORTLAST_SANITIZED") == "yes"  # everything takes several times as long


class Folder:
    """A temporary folder that is also TMPDIR of what runs in it, so that leftovers can be seen."""

    def __enter__(self):
        self.holder = tempfile.TemporaryDirectory(prefix="slt-")
        self.path = self.holder.name
        os.mkdir(self.file("tmp"))
        return self

    def __exit__(self, *unused):
        self.holder.cleanup()

    def file(self, name):
        return os.path.join(self.path, name)

    def write(self, name, text):
        with open(self.file(name), "w") as out:
            out.write(text)
        return self.file(name)

    def environment(self, **more):
        return dict(os.environ, TMPDIR=self.file("tmp"), **more)

    def start(self, *arguments, **keywords):
        return subprocess.Popen([SORTLAST, *map(str, arguments)], cwd=self.path, env=self.environment(),
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **keywords)

    def run(self, *arguments, timeout=120, **keywords):
        """Runs the command; returns (exit status, standard output, standard error)."""
        process = self.start(*arguments, **keywords)
        try:
            out, err = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            raise AssertionError("still running after %d s: %s" % (timeout, " ".join(map(str, arguments))))
        return process.returncode, out, err

    def render(self, scene, *arguments):
        """Renders quietly and returns the JSON summary."""
        code, out, err = self.run("render", scene, "-q", "--json", self.file("run.json"), *arguments)
        assert code == 0, "render failed (%d): %s" % (code, err)
        with open(self.file("run.json")) as summary:
            return json.load(summary)

    def assert_same_picture(self, a, b):
        code, out, err = self.run("compare", a, b)
        assert code == 0 and "max_error 0" in out.splitlines()[0], "pictures differ:\n%s%s" % (out, err)

    def assert_nothing_left(self):
        """No node process of this test, no socket folder."""
        deadline = time.time() + 5
        while time.time() < deadline and (processes_in(self.path) or os.listdir(self.file("tmp"))):
            time.sleep(0.02)
        assert not processes_in(self.path), "processes left: %s" % processes_in(self.path)
        assert not os.listdir(self.file("tmp")), "files left: %s" % os.listdir(self.file("tmp"))


def read_exr(path):
    """Channels of an uncompressed OpenEXR file: name -> rows of numbers (floats, or whole numbers of UINT)."""
    with open(path, "rb") as file:
        data = file.read()
    at, attributes = 8, {}
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), data.index(b"\0", end + 1) + 1
        size, = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    assert attributes["compression"] == b"\0", "the picture is compressed"
    channels, text, place = [], attributes["channels"], 0
    while text[place]:
        end = text.index(b"\0", place)
        channels.append((text[place:end].decode(), struct.unpack_from("<i", text, end + 1)[0]))
        place = end + 17
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    planes = {name: [] for name, kind in channels}
    at += 1 + 8 * height  # the offsets of the lines
    for _ in range(height):
        at += 8
        for name, kind in channels:
            code, size = [("I", 4), ("e", 2), ("f", 4)][kind]
            planes[name].append(struct.unpack_from("<%d%s" % (width, code), data, at))
            at += size * width
    return planes


def processes_in(path):
    """Process IDs and command lines of node programs whose working directory is `path`."""
    found = []
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            if os.readlink("/proc/%s/cwd" % entry) != path:
                continue
            with open("/proc/%s/cmdline" % entry, "rb") as line:
                words = line.read().split(b"\0")
        except OSError:
            continue
        if b"sortlast" in os.path.basename(words[0]):
            found.append((int(entry), b" ".join(words).decode()))
    return found


def node_process(folder, program, index=0):
    for pid, line in processes_in(folder.path):
        words = line.split()
        if os.path.basename(words[0]) == program and ("--index" not in words or words[words.index("--index") + 1] == str(index)):
            return pid
    return None


class Skipped(Exception):
    pass


def main(names):
    failed = skipped = 0
    for name, function in list(names.items()):
        if not name.startswith("test_"):
            continue
        begin = time.time()
        try:
            function()
            print("ok      %s (%.1f s)" % (name, time.time() - begin), flush=True)
        except Skipped as reason:
            skipped += 1
            print("skipped %s: %s" % (name, reason), flush=True)
        except Exception:
            failed += 1
            print("FAILED  %s" % name)
            traceback.print_exc(file=sys.stdout)
            sys.stdout.flush()
    sys.exit(1 if failed else 0)
