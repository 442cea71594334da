# SPDX-License-Identifier: Apache-2.0
"""Paced runs: a cluster whose sockets are throttled to SCALE times the machine's bandwidth takes, on the real clock and
times SCALE, the time the model solves. tests/nodes/test_pacer.c shows the same on a virtual clock, to 0.01 %."""

import json
import os
import statistics
import subprocess
import time

from harness import BUILD, SCENES, SOURCE, Folder, Skipped, main

BOWLING = os.path.join(SCENES, "bowling", "bowling.rib")
FRAMES = 6           # the first also pays for loading shaders and building trees: it is left out
TOLERANCE = 0.05
WALL_S = (0.8, 2.5)  # a paced frame lasts no less and no more
HEADROOM = 15        # and this many times what the host needs for the same frame unpaced


def wake_up_lag_s():
    """How late this machine wakes a process that sleeps, 9 times of 10."""
    lags = []
    for i in range(200):
        begin = time.monotonic()
        time.sleep(0.001)
        lags.append(time.monotonic() - begin - 0.001)
    return sorted(lags)[180]


def changed_machine(folder, **changes):
    with open(os.path.join(SOURCE, "machines", "pixelflow.json")) as file:
        machine = json.load(file)
    for name, value in changes.items():
        assert name in machine["parameters"]
        machine["parameters"][name]["value"] = value
    return folder.write("machine.json", json.dumps(machine))


def paced_scale(folder, *arguments):
    """A scale at which this host is not the limit."""
    folder.render(BOWLING, *arguments)  # shaders are compiled now
    first_s = folder.render(BOWLING, *arguments)["wall_s"]
    summary = folder.render(BOWLING, *arguments, "--frames", FRAMES)
    frame_s = (summary["wall_s"] - first_s) / (FRAMES - 1)
    wall_s = max(WALL_S[0], HEADROOM * frame_s)
    lag = wake_up_lag_s()
    if wall_s > WALL_S[1] or lag > 0.002:
        raise Skipped("this machine is too busy or too slow to pace: a frame takes %.2f s, a wake-up %.1f ms" %
                      (frame_s, lag * 1000))
    return summary["frames"][-1]["time_ps"] * 1e-12 / wall_s


def median_error(pace):
    errors = [frame["scaled_wall_ps"] / frame["time_ps"] - 1 for frame in pace["frames"][1:]]
    assert len(errors) == FRAMES - 1, errors
    print("        scale %.5f: %s, median %+.2f %%" % (pace["scale"], " ".join("%+.2f %%" % (100 * e) for e in errors),
                                                     100 * statistics.median(errors)))
    return statistics.median(errors)


def judge(scale, run):
    """What this host adds to a frame is half as much of one twice as long; a wrong pace stays as wrong."""
    for slower in (1, 2):
        pace = run(scale / slower)
        assert abs(pace["scale"] * slower / scale - 1) < 1e-6
        error = median_error(pace)
        if abs(error) < TOLERANCE:
            return
    raise AssertionError("%+.2f %%" % (100 * error))


def check_paced(folder, *arguments):
    arguments = [*arguments, "--format", "640x512"]
    judge(paced_scale(folder, *arguments), lambda scale: folder.render(
        BOWLING, *arguments, "--frames", FRAMES, "--pace", "%.9g" % scale)["pace"])
    folder.assert_nothing_left()


def test_wall_time_times_scale_is_the_solved_time():
    with Folder() as folder:
        check_paced(folder, "-r", 2, "-s", 4)


def test_also_where_the_composition_network_is_the_limit():
    with Folder() as folder:
        machine = changed_machine(folder, composition_bytes_per_s=100000000)
        check_paced(folder, "-r", 3, "-s", 3, "--machine", machine, "--transport", "tcp")


# A cluster of 1 + 3 nodes whose rendering node sits in a network namespace of its own: all it sends passes the
# kernel's token bucket. Standard output is the summary.
NETWORK = """set -e
ip link set lo up
unshare -n sleep 60 & keeper=$!
trap 'kill $keeper' EXIT
sleep 0.3
ip link add v0 mtu 65000 type veth peer name v1 mtu 65000 netns $keeper
ip addr add 10.9.0.1/24 dev v0
ip link set v0 up
nsenter -t $keeper -n sh -c 'ip addr add 10.9.0.2/24 dev v1; ip link set v1 up'
nsenter -t $keeper -n tc qdisc add dev v1 root tbf rate {rate}bps burst 70kb limit 64mb
"""
SHAPED = NETWORK + """cd {build}
nsenter -t $keeper -n ./sortlast-rendering-node --host tcp://10.9.0.1:5555 --listen "tcp://10.9.0.2:*" & nodes=$!
for j in 0 1 2; do
    ./sortlast-shading-node --host tcp://10.9.0.1:5555 --index $j --listen "tcp://10.9.0.1:*" & nodes="$nodes $!"
done
./sortlast-framebuffer-node --host tcp://10.9.0.1:5555 --listen "tcp://10.9.0.1:*" & nodes="$nodes $!"
./sortlast-host --bind tcp://10.9.0.1:5555 -r 1 -s 3 -q --json - {arguments} {scene}
wait $nodes
"""


def may_shape():
    """Whether this system lets us make network namespaces and shape traffic in them."""
    try:
        return subprocess.run(["unshare", "-rn", "sh", "-c", NETWORK.format(rate=1000000)], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL).returncode == 0
    except OSError:
        return False


def test_also_when_the_kernel_shapes_the_traffic():
    if not may_shape():
        raise Skipped("network namespaces with tc tbf are not permitted here")
    with Folder() as folder:
        rate = 100000000
        arguments = ["--format", "640x512", "--machine", changed_machine(folder, composition_bytes_per_s=rate)]
        scale = paced_scale(folder, "-r", 1, "-s", 3, *arguments)

        def run(scale):
            more = [*arguments, "--frames", str(FRAMES), "--pace", "%.9g" % scale, "--pace-shaped"]
            script = SHAPED.format(rate=round(rate * scale), build=BUILD, scene=BOWLING, arguments=" ".join(more))
            result = subprocess.run(["unshare", "-rn", "sh", "-c", script], stdout=subprocess.PIPE, timeout=60,
                                    env=folder.environment())
            assert result.returncode == 0
            return json.loads(result.stdout)["pace"]

        judge(scale, run)


def test_a_paced_picture_is_the_picture():
    with Folder() as folder:
        small = ["--format", "160x128", "--compression", "none"]
        folder.render(BOWLING, "-o", folder.file("free.exr"), *small)
        folder.render(BOWLING, "-o", folder.file("paced.exr"), *small, "-r", 2, "-s", 2, "--pace", 0.1)
        folder.assert_same_picture(folder.file("free.exr"), folder.file("paced.exr"))


def test_a_pace_that_cannot_be_is_refused():
    with Folder() as folder:
        for pace, more in (("0", []), ("-1", []), ("1e9", []), ("x", []), ("nan", []), ("0.1", ["--driver", "in-process"])):
            code, out, err = folder.run("render", BOWLING, "--pace", pace, *more)
            assert code == 1 and "--pace" in err, (pace, code, err)


if __name__ == "__main__":
    main(globals())
