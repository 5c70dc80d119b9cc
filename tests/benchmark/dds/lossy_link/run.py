#!/usr/bin/env python3
"""Images and tiles over a lossy link between two network namespaces: a table of what arrives, when, and at what cost.

Needs root (network namespaces, TUN devices). Prints Markdown and, with --csv, writes the same rows as CSV. Options after
"--" go to both sides; lapis_lossy_link publish --help lists them."""
import argparse
import csv
import json
import os
import select
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
BIN = Path(os.environ.get("LAPIS_BIN", ROOT / "build/release/bin"))
KERNEL_DEFAULT = 212_992  # net.core.rmem_max of Linux [B]
# As Lapis 1.0 sent, on every link.
BEFORE = ["--message-bytes", "65500", "--pace-bytes", "0", "--depth", "0", "--heartbeat-ns", "0",
          "--heartbeat-response-ns", "0", "--nack-suppression-ns", "0", "--heartbeat-with-data", "true"]
REAL_TIME = ["chrt", "--rr", "5"]
LEAST_IMAGES_PERCENT, LONGEST_WRITE_MS = 95, 10  # --check; of tiles none may be missing
SKIPPED = 77  # SKIP_RETURN_CODE of ctest
LOADS = {"raw": [], "no_tiles": ["--tiles", "0"], "compressed": ["--image-bytes", "90000"]}
COLUMNS = ("library", "settings", "load", "loss_percent", "delay_ms", "images_percent", "images_hz", "age_p50_ms",
           "age_p95_ms", "tiles_percent", "tiles_s", "sent_per_payload", "write_p50_ms", "write_p99_ms",
           "publisher_cpu_percent", "subscriber_cpu_percent")


class Process:
    """A child that prints lines of JSON."""

    def __init__(self, command, **options):
        self.child = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE, text=True, **options)

    def line(self, timeout_s=20):
        """The next line; an empty object when none comes."""
        readable, _, _ = select.select([self.child.stdout], [], [], timeout_s)
        text = self.child.stdout.readline() if readable else ""
        return json.loads(text) if text else {}

    def end(self):
        self.child.send_signal(signal.SIGTERM)
        result = self.line()
        self.child.wait()
        return result


def configure(namespace, number, queue):
    """Addresses and the multicast route of one end."""
    for command in ("link set lo up", f"addr add 10.99.0.{number}/24 dev lossy",
                    f"link set lossy up multicast on mtu 1500 txqueuelen {queue}", "route add 224.0.0.0/4 dev lossy"):
        subprocess.run(["nsenter", f"--net={namespace}", "ip", *command.split()], check=True)


def measure(arguments, settings, load, loss, delay):
    children = []

    def start(command, real_time, **options):
        children.append(Process([*REAL_TIME, *command] if real_time else command, **options))
        return children[-1]

    try:
        link = start([arguments.program, "link", "--loss", loss, "--delay", delay, "--seed", arguments.seed,
                      "--rate", arguments.rate, "--outage-after", 4, "--outage", arguments.outage],
                     real_time=True)  # a real one does not wait for a processor
        namespaces = link.line()["namespaces"]
        for number, namespace in enumerate(namespaces, start=1):
            configure(namespace, number, arguments.queue)
        common = ["--socket-buffer", arguments.socket_buffer, *(BEFORE if settings == "before" else []),
                  *arguments.options]
        environment = {**os.environ, "ROS_DOMAIN_ID": str(arguments.domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
        environment.pop("LAPIS_RUN", None)
        subscriber, publisher = (
            start(["nsenter", f"--net={namespace}", arguments.program, name, *common, *options], arguments.real_time,
                  env=environment)
            for name, namespace, options in (
                ("subscribe", namespaces[1], []),
                ("publish", namespaces[0], [*LOADS[load], "--images", int(15 * arguments.seconds)])))
        sent = publisher.line(timeout_s=arguments.seconds + 60)
        return row(arguments, settings, load, loss, delay, sent, subscriber.end(), link.end())
    finally:
        for process in children:
            process.child.kill()
            process.child.wait()


def row(arguments, settings, load, loss, delay, sent, received, carried):
    result = dict.fromkeys(COLUMNS, "-")
    result.update(library=arguments.library, settings=settings, load=load, loss_percent=loss, delay_ms=delay)
    if not sent or not received:
        return result
    image_bytes = int(LOADS[load][1]) if load == "compressed" else 691_200
    payload = sent["images"] * image_bytes + sent["tiles"] * 100_000
    result.update(
        images_percent=round(100 * received["images"] / sent["images"], 1),
        images_hz=round(received["images"] / sent["seconds"], 1),
        age_p50_ms=round(1e3 * received["age_p50_s"]), age_p95_ms=round(1e3 * received["age_p95_s"]),
        tiles_percent=round(100 * received["tiles"] / max(1, sent["tiles"]), 1), tiles_s=round(received["tiles_s"], 2),
        sent_per_payload=round(carried["forth"]["bytes"] / payload, 2),
        write_p50_ms=round(sent["write_p50_ms"], 2), write_p99_ms=round(sent["write_p99_ms"], 2),
        publisher_cpu_percent=round(100 * sent["cpu_s"] / sent["seconds"]),
        subscriber_cpu_percent=round(100 * received["cpu_s"] / sent["seconds"]))
    if arguments.verbose:
        print(json.dumps({"sent": sent, "received": received, "carried": carried}), file=sys.stderr)
    return result


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=BIN / "lapis_lossy_link")
    parser.add_argument("--library", default="installed", help="name of the Fast DDS that the program has, for the table")
    parser.add_argument("--settings", nargs="+", choices=("before", "after"), default=["before", "after"])
    parser.add_argument("--load", nargs="+", choices=sorted(LOADS), default=["raw"])
    parser.add_argument("--loss", nargs="+", type=float, default=[0, 1, 5], help="[%%]")
    parser.add_argument("--delay", nargs="+", type=float, default=[0, 50], help="one way [ms]")
    parser.add_argument("--seconds", type=float, default=20, help="of images")
    parser.add_argument("--rate", type=float, default=0, help="of the link [Mbit/s]; default: any")
    parser.add_argument("--outage", type=float, default=0, help="how long nothing arrives, from the 4th second on [s]")
    parser.add_argument("--socket-buffer", type=int, default=KERNEL_DEFAULT, help="that is asked for [B]")
    parser.add_argument("--queue", type=int, default=10_000, help="packets that wait at an end of the link")
    parser.add_argument("--real-time", action="store_true",
                        help="real-time priority for both sides, too, on a machine that has other work")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--domain", type=int, default=151)
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--check", action="store_true", help="1 and 5 %% loss with 50 ms, settings of now, 6 s, --real-time: "
                        f"status 1 unless all tiles and {LEAST_IMAGES_PERCENT} %% of the images arrive and writing takes "
                        f"{LONGEST_WRITE_MS} ms at most (p99); status {SKIPPED} where a link cannot be made")
    parser.add_argument("--verbose", action="store_true")
    own = sys.argv[1:]
    options = []
    if "--" in own:
        own, options = own[:own.index("--")], own[own.index("--") + 1:]
    if "--check" in own:
        parser.set_defaults(settings=["after"], loss=[1, 5], delay=[50], seconds=6, real_time=True)
    arguments = parser.parse_args(own)
    arguments.options = options
    return arguments


def is_good(result):
    """What --check demands; it says the figures."""
    if result["images_percent"] == "-":
        print("a side of the link has ended early")
        return False
    print(f"figure: {result['loss_percent']:g} % lost, {result['delay_ms']:g} ms: {result['images_percent']} % of the images, "
          f"age p95 {result['age_p95_ms']} ms; {result['tiles_percent']} % of the tiles; write p99 "
          f"{result['write_p99_ms']} ms", flush=True)
    return (result["tiles_percent"] == 100 and result["images_percent"] >= LEAST_IMAGES_PERCENT and
            result["write_p99_ms"] <= LONGEST_WRITE_MS)


def main():
    arguments = parse()
    if arguments.check and (os.geteuid() != 0 or not Path("/dev/net/tun").exists()):
        print("SKIPPED: a link needs root and TUN devices")
        return SKIPPED
    print("| " + " | ".join(COLUMNS) + " |\n|" + " --- |" * len(COLUMNS), flush=True)
    rows = []
    for settings in arguments.settings:
        for load in arguments.load:
            for loss in arguments.loss:
                for delay in arguments.delay:
                    rows.append(measure(arguments, settings, load, loss, delay))
                    print("| " + " | ".join(f"{value:g}" if isinstance(value, float) else str(value)
                                            for value in rows[-1].values()) + " |", flush=True)
    if arguments.csv:
        with arguments.csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(rows)
    return 0 if not arguments.check or all([is_good(result) for result in rows]) else 1


if __name__ == "__main__":
    sys.exit(main())
