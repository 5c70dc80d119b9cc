"""Three machines on one host: network namespaces, each with an address in a subnet of its own, and a router between them.

No multicast passes the router, so that processes of different machines meet by static peers or a Discovery Server only.
Needs root. All of it goes with the processes that hold the namespaces, however the test ends.
"""
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import chain

NAMES = ("robot", "mapping", "planning")
SERVER_PORT = 11811


class Machine:
    """A network namespace, which lives as long as the process that holds it."""

    def __init__(self, name):
        self.name = name
        self.holder = subprocess.Popen(["setpriv", "--pdeathsig", "KILL", "unshare", "--net", "sleep", "infinity"])
        self.namespace = f"/proc/{self.holder.pid}/ns/net"
        self.enter = ["nsenter", f"--net={self.namespace}"]
        self.address = None

    def wait_until_it_is_apart(self):
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(self.namespace) == own:
            if self.holder.poll() is not None:
                raise OSError("unshare --net is not permitted")
            time.sleep(0.01)

    def output(self, *command):
        return subprocess.run([*self.enter, *command], check=True, capture_output=True, text=True).stdout

    def ip(self, text):
        self.output("ip", *text.split())

    def close(self):
        self.holder.kill()
        self.holder.wait()


class Network:
    """The machines, the router, and a link from the router to each machine, named as the machine is."""

    def __init__(self):
        self.router = Machine("router")
        self.machines = {name: Machine(name) for name in NAMES}
        try:
            for machine in (self.router, *self.machines.values()):
                machine.wait_until_it_is_apart()
                machine.ip("link set lo up")
            for number, machine in enumerate(self.machines.values(), start=1):
                self._link(machine, f"10.99.{number}")
            self.router.output("sh", "-c", "echo 1 > /proc/sys/net/ipv4/ip_forward")
        except BaseException:
            self.close()
            raise

    def _link(self, machine, subnet):
        machine.address = f"{subnet}.2"
        self.router.ip(f"link add {machine.name} type veth peer name air netns {machine.holder.pid}")
        self.router.ip(f"address add {subnet}.1/24 dev {machine.name}")
        self.router.ip(f"link set {machine.name} up")
        machine.ip(f"address add {machine.address}/24 dev air")
        machine.ip("link set air up")
        machine.ip(f"route add default via {subnet}.1")
        # Fast DDS uses the interfaces that are up when a process starts, and no others.
        self.wait_until_it_sees(machine.name, True)

    def wait_until_it_sees(self, name, is_up):
        """Waits until a machine sees that its link is up, or that it is not."""
        while (" state UP " in self.machines[name].output("ip", "-o", "link", "show", "air")) != is_up:
            time.sleep(0.01)

    def __getitem__(self, name):
        return self.machines[name]

    def cut(self, name):
        """From now on nothing gets to the machine or from it; it has its address still, as one out of range has."""
        self.router.ip(f"link set {name} down")

    def heal(self, name):
        self.router.ip(f"link set {name} up")

    def static_peers(self):
        """Settings by which the processes of all machines find each other."""
        return {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
                "ROS_STATIC_PEERS": ";".join(machine.address for machine in self.machines.values())}

    def discovery_server(self):
        """The same with a server on the robot, which has to be started."""
        return {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
                "ROS_DISCOVERY_SERVER": f"{self.machines['robot'].address}:{SERVER_PORT}"}

    def start_server(self, log):
        """fast-discovery-server of Fast DDS (Debian: fastdds-tools) on the robot, ready."""
        robot = self.machines["robot"]
        server = chain.Process([*robot.enter, "stdbuf", "-oL", shutil.which("fast-discovery-server"), "-i", "0", "-l",
                                robot.address, "-p", SERVER_PORT], log)
        if not server.wait_for_text("Server is running"):
            server.kill()
            raise AssertionError(f"the server is not ready: {server.output()}")
        return server

    def bytes_carried(self):
        """Bytes that each machine has sent to the router, and received from it, so far."""
        table = self.router.output("cat", "/proc/net/dev")
        rows = [line.replace(":", " ").split() for line in table.splitlines()[2:]]
        return {row[0]: (int(row[1]), int(row[9])) for row in rows if row[0] in self.machines}

    def close(self):
        for machine in (*self.machines.values(), self.router):
            machine.close()


def network_or_skip():
    """The network; ends the process as skipped, saying why, where it cannot be made."""
    try:
        return Network()
    except (OSError, subprocess.CalledProcessError) as error:
        print("SKIPPED: no links between network namespaces here:", getattr(error, "stderr", None) or error)
        sys.exit(chain.SKIPPED)


def server_or_skip():
    """Ends the process as skipped where there is no Discovery Server."""
    if shutil.which("fast-discovery-server") is None:
        print("SKIPPED: no fast-discovery-server, which Debian has in fastdds-tools")
        sys.exit(chain.SKIPPED)


class Exploration:
    """A free-running exploration, its processes spread over the machines."""

    def __init__(self, network, folder, scene, settings, options=(), mapping="mapping"):
        """`mapping`: where slam and the mapper run."""
        self.network = network
        self.folder = Path(folder)
        self.scene = scene
        self.mapping = mapping
        self.options = [str(option) for option in options]
        self.settings = {**settings, "LAPIS_RUN": f"machines-{os.getpid()}"}
        self.processes = {}

    def start_program(self, machine, words, name):
        """A program on a machine, with the settings of all."""
        variables = [f"{key}={value}" for key, value in self.settings.items()]
        process = chain.Process([*self.network[machine].enter, "env", "-u", "ROS_STATIC_PEERS", "-u",
                                 "ROS_DISCOVERY_SERVER", *variables, *words], self.folder / f"{name}.log")
        self.processes[name] = process
        return process

    def start(self, machine, component, *arguments, ready=True):
        words = [chain.BIN / f"lapis_{component}", *arguments]
        process = self.start_program(machine, words, component)
        if ready and not process.wait_for_text(f" {component}: ready"):
            raise AssertionError(f"{component} is not ready: {process.output()}")
        return process

    def start_all(self):
        robot = ["--config", chain.REPOSITORY / "config/robot.yaml", *self.options]
        run = self.folder / "run"
        self.start(self.mapping, "slam", "--set", f"slam.output_dir={run}")
        self.start(self.mapping, "semantic_mapper", *robot, "--set", f"semantic_mapper.output_dir={run}",
                   "--set", f"semantic_mapper.stored_frames.spill_dir={self.folder}")
        self.start("planning", "planner", *robot, "--set", f"planner.output_dir={run}",
                   "--set", "planner.method=nearest")
        self.start("robot", "controller", *robot)
        self.start("robot", "simulator", self.scene, "--mode", "freerun", *robot, *chain.NO_FURNITURE,
                   "--set", "simulator.wait_for_readers=3", "--set", f"simulator.world.light_folder={self.folder}")

    def stop_all(self):
        """Ends them in the order in which the supervisor ends a run; returns the status of each."""
        order = ("simulator", "slam", "semantic_mapper", "planner", "controller")
        return {name: self.processes[name].stop() for name in order}

    def kill_all(self):
        for process in self.processes.values():
            process.kill()
